#pragma once
// What books the energy of water on a grid, step by step.

#include <abrade/fluid/energy/water_content.hpp>
#include <abrade/fluid/momentum/momentum.hpp>
#include <abrade/fluid/water_energy.hpp>

#include <algorithm>
#include <span>
#include <unordered_map>
#include <utility>
#include <vector>

namespace abrade::detail {

/// Books a WaterEnergy. Forces and fluxes are those of one velocity a step, by which the liquid moves from
/// its beginning to its end: in a full box the mean of the velocities before and after the step; below a
/// surface the velocity itself, which is staggered in time. There the kinetic energy at the liquid's time is
/// that of the mean of the velocities half a step before and after it. Both are of second order in the step.
template <int Dim, class State, class Scheme, class Liquid = VolumeOfFluid<Dim>>
class EnergyAccount {
    static constexpr int vertical = Grid<Dim>::vertical;

public:
    using View = EnergyView<Dim, State, Liquid>;

    /// `before`: the velocity by which the liquid came to where it is, ghosts filled; at the start the
    /// present one.
    EnergyAccount(const View& flow, FaceField<Dim, State> before)
        : content_(flow), mid_(std::move(before)), scratch_(face_field<Dim, State>(flow.grid.layout())),
          still_(scratch_) {
        for (int a = 0; a < Dim; ++a)
            for (const bool high : {false, true})
                if (const Boundary side = flow.params.boundaries[a][high];
                    side == Boundary::inflow || side == Boundary::outflow)
                    flow.grid.for_each_beside(a, high, [&](const CellNumber<Dim>&, Offset c) {
                        boundary_faces_.push_back({c, a, high, side == Boundary::inflow});
                    });
        look(flow);
        energy_.kinetic_start = energy_.kinetic, energy_.potential_start = energy_.potential;
    }

    const WaterEnergy& energy() const noexcept { return energy_; }

    /// Below a surface, when the liquid has moved with the velocity and nothing else has.
    void liquid_moved(const View& flow) {
        mid_ = flow.velocity;
        for (BoundaryFace& o : boundary_faces_) {
            o.volume = (*flow.flux)[o.axis][o.face(flow.grid)];
            o.pressure = static_cast<Real>(pressure_at(flow, o));
        }
        for (const SolidVolume& s : flow.liquid->solid_moved())
            if (BoundaryFace* o = boundary_face_at(flow, s.axis, s.face)) o->volume -= s.volume;
    }
    void walls_took(const typename WallFriction<Dim>::PerFace& taken) { taken_ = taken; }

    /// The step of dt [s] is done.
    void took(const View& flow, Real dt) {
        if (!flow.liquid) find_middle(flow, dt);
        WaterEnergy change;
        body_force(flow, dt, change);
        viscous(flow, dt, change);
        change.wall_friction =
            work_at_faces(flow, [&](auto&& of_face) { flow.friction.for_each(taken_, of_face); });
        if (flow.gains)
            change.forcing = work_at_faces(flow, [&](auto&& of_face) {
                for (int a = 0; a < Dim; ++a)
                    for (const FaceGain& g : (*flow.gains)[a]) of_face(a, g.face, g.gain - g.drained);
            });
        change.sources = brought_by_sources(flow);
        const Real carried = through_boundary(flow, change);
        if (!flow.liquid)
            change.advection =
                carried - 0.5 * (advection(flow, flow.before, dt) + advection(flow, flow.stage, dt));
        change.solid_friction = flow.solid_friction;
        change.reshaped = -kinetic(flow, flow.new_solids) - potential(flow, flow.new_solid_moment);
        const Real before = energy_.total();
        look(flow);
        change.numerical = change.supplied() - change.dissipated() - (energy_.total() - before);
        energy_.inflow += change.inflow, energy_.outflow += change.outflow;
        energy_.boundaries += change.boundaries, energy_.body_force += change.body_force;
        energy_.viscous += change.viscous, energy_.turbulent += change.turbulent;
        energy_.wall_friction += change.wall_friction, energy_.numerical += change.numerical;
        energy_.reshaped += change.reshaped, energy_.forcing += change.forcing;
        energy_.sources += change.sources;
        energy_.advection += change.advection, energy_.solid_friction += change.solid_friction;
    }

    /// What solids were given by the water, once it is known [J].
    void solids_took(Real work) { energy_.solids -= work, energy_.numerical -= work; }

    /// Other walls stand in the box, between steps.
    void reshaped(const View& flow) {
        content_.look_at_walls(flow);
        const Real before = energy_.total();
        look(flow);
        energy_.reshaped += energy_.total() - before;
    }

    static void fields(auto&& field) {
        field("mid", "m/s", &EnergyAccount::mid_),
            field.bytes("boundary_faces", &EnergyAccount::boundary_faces_),
            field("energy", &EnergyAccount::energy_);
    }

private:
    /// A face through which water may flow in or out of the box.
    struct BoundaryFace {
        Offset cell = 0;
        int axis = 0;
        bool high = false, inflow = false;
        Real volume = 0;    ///< that went through in the step, along the axis [m3]
        Real pressure = 0;  ///< when the step began, over density [m2/s2]

        Offset face(const Grid<Dim>& grid) const noexcept {
            return high ? cell + grid.layout().stride[axis] : cell;
        }
        Offset face_inside(const Grid<Dim>& grid) const noexcept {
            return high ? cell : cell + grid.layout().stride[axis];
        }
    };

    void look(const View& flow) {
        energy_.kinetic = content_.kinetic(flow, mid_), energy_.potential = content_.potential(flow);
        energy_.kinetic -= kinetic(flow, flow.solids);  // what solids take up is no water
        energy_.potential -= potential(flow, flow.solid_moment);
    }

    /// Of water in the place of solids.
    Real kinetic(const View& flow, std::span<const SolidVolume> solids) const {
        return 0.5 * in_solids(flow, solids, [&](int a, Offset c) {
                   const auto now = static_cast<Real>(flow.velocity[a][c]);
                   return square(flow.liquid ? 0.5 * (now + static_cast<Real>(mid_[a][c])) : now);
               });
    }
    Real potential(const View& flow, const Point<Dim>& moment) const {
        return -flow.params.density * content_.gravity().dot(moment);
    }
    /// Density times the sum over what is solid of control volumes.
    static Real in_solids(const View& flow, std::span<const SolidVolume> solids, auto&& of_face) {
        Real sum = 0;
        for (const SolidVolume& s : solids) sum += s.volume * of_face(s.axis, s.face);
        return flow.params.density * sum;
    }
    BoundaryFace* boundary_face_at(const View& flow, int axis, Offset face) noexcept {
        const auto found = std::ranges::find_if(boundary_faces_, [&](const BoundaryFace& o) {
            return o.axis == axis && o.face(flow.grid) == face;
        });
        return found == boundary_faces_.end() ? nullptr : &*found;
    }

    /// Of a full box, the velocity in the middle of the step and what it carried through faces of the
    /// boundary.
    void find_middle(const View& flow, Real dt) {
        for (int a = 0; a < Dim; ++a)
            parallel_for(static_cast<Index>(mid_[a].size()), [&](Index c) {
                mid_[a][c] = State(0.5) * (flow.before[a][c] + flow.velocity[a][c]);
            });
        for (BoundaryFace& o : boundary_faces_) {
            const CellNumber<Dim> cell = flow.grid.layout().number(o.cell);
            o.volume = dt * static_cast<Real>(mid_[o.axis][o.face(flow.grid)]) * flow.grid.volume(cell) /
                       flow.grid.size(o.axis, cell[o.axis]);
            o.pressure = pressure_at(flow, o);
        }
        for (const SolidFlux& s : flow.solid_fluxes)
            if (BoundaryFace* o = boundary_face_at(flow, s.axis, s.face)) {
                const CellNumber<Dim> cell = flow.grid.layout().number(o->cell);
                o->volume -= dt * s.speed * flow.grid.volume(cell) / flow.grid.size(s.axis, cell[s.axis]);
            }
    }

    /// By cells, half of each face's velocity: so the half volumes at sides have their part.
    void body_force(const View& flow, Real dt, WaterEnergy& change) const {
        Point<Dim> push = content_.along_periodic();
        if (flow.params.body_force) push += flow.params.body_force(flow.time + 0.5 * dt);
        for (int a = 0; a < Dim; ++a) {
            if (push[a] == 0) continue;
            const Offset up = flow.grid.layout().stride[a];
            change.body_force +=
                flow.params.density * dt * push[a] *
                sum_over_rows(content_.rows(flow), [&](int plane, int row, const RowRange& r) {
                    const Offset start = flow.grid.layout().row_start(plane, row);
                    const auto volume = content_.volume().row(row);
                    const State* const u = mid_[a].data() + start;
                    Real sum = 0;
                    for (int i = r.begin; i < r.end; ++i) {
                        const Offset c = start + i;
                        const Real liquid_fraction =
                            flow.liquid
                                ? 0.5 * ((*flow.liquid_fraction)[c] + (*flow.liquid_fraction_before)[c])
                                : Real(1);
                        const Real twice = static_cast<Real>(u[i]) + static_cast<Real>(u[i + up]);
                        sum += liquid_fraction == 0 ? 0 : 0.5 * liquid_fraction * twice * volume[i];
                    }
                    return sum;
                });
            change.body_force -= dt * push[a] * in_solids(flow, flow.solids, [&](int axis, Offset c) {
                                     return axis == a ? static_cast<Real>(mid_[a][c]) : 0;
                                 });
        }
    }

    /// Work on `mid_` of friction within the water, by the same kernel as in the step; what sides that move
    /// put in is not lost.
    void viscous(const View& flow, Real dt, WaterEnergy& change) {
        const Real nu = flow.params.viscosity / flow.params.density;
        if (nu > 0) {
            change.viscous = -stage_work<Upwind, false>(flow, {mid_, still_, dt, nu});
            change.viscous += work_in_solids(flow) - work_at_boundary(flow);
            change.boundaries = work_of_sides(flow, dt * flow.params.viscosity);
            change.viscous += change.boundaries;
        }
        if (flow.eddies) {
            change.turbulent = -stage_work<Upwind, true>(flow, {mid_, still_, dt, 0});
            change.turbulent += work_in_solids(flow) - work_at_boundary(flow);
        }
    }
    /// Work of the momentum that is carried about the control volumes of a velocity, on `mid_`.
    Real advection(const View& flow, const FaceField<Dim, State>& by, Real dt) {
        return stage_work<Scheme, false>(flow, {by, flow.advecting_flux ? *flow.advecting_flux : by, dt, 0});
    }

    struct Forces {
        const FaceField<Dim, State>&velocity, &advecting_flux;
        Real seconds, viscosity;
    };
    /// Work on `mid_` of what one stage does to a velocity.
    template <class Flux, bool Eddies>
    Real stage_work(const View& flow, const Forces& f) {
        MomentumStage<Dim, State> stage{f.velocity, f.advecting_flux, f.velocity,
                                        scratch_,   flow.pressure,    f.seconds};
        stage.viscosity = f.viscosity;
        if (flow.walls) stage.aperture = &flow.walls->aperture(), stage.open_friction = flow.open_friction;
        stage.eddy_viscosity = flow.eddies;
        advance_momentum<Flux, Eddies>(flow.grid, flow.faces, stage);
        Real work = 0;
        for (int a = 0; a < Dim; ++a)
            work += sum_over_rows(flow.faces[a], [&](int plane, int row, const RowRange& r) {
                const Offset start = flow.grid.layout().row_start(plane, row);
                const Offset back = flow.grid.layout().stride[a];
                const auto volume = content_.control_volume(a).row(row);
                const State* const was = f.velocity[a].data() + start;
                const State* const is = scratch_[a].data() + start;
                const State* const by = mid_[a].data() + start;
                const Real* const liquid_fraction =
                    flow.liquid_fraction ? flow.liquid_fraction->data() + start : nullptr;
                Real sum = 0;
#pragma omp simd reduction(+ : sum)
                for (int i = r.begin; i < r.end; ++i) {
                    const Real gained = static_cast<Real>(is[i]) - static_cast<Real>(was[i]);
                    const bool counts = !liquid_fraction || content_.carries(liquid_fraction + i, back);
                    sum += counts ? gained * static_cast<Real>(by[i]) * volume[i] : 0;
                }
                return sum;
            });
        return flow.params.density * work;
    }
    /// Friction: the half volume of such a face of the boundary has no momentum of its own, it loses what
    /// that of the next face does. After `stage_work`.
    Real work_at_boundary(const View& flow) const {
        Real work = 0;
        for (const BoundaryFace& o : boundary_faces_) {
            const Offset face = o.face_inside(flow.grid);
            const Real gained =
                static_cast<Real>(scratch_[o.axis][face]) - static_cast<Real>(mid_[o.axis][face]);
            if (flow.grid.cells(o.axis) > 1 && content_.liquid_of_face(flow, o.axis, face) > 0)
                work += 0.5 * gained * static_cast<Real>(mid_[o.axis][face]) *
                        content_.control_volume_of(flow, o.axis, face);
        }
        return flow.params.density * work;
    }
    /// Friction of what is no water, in faces that `stage_work` has been at.
    Real work_in_solids(const View& flow) const {
        constexpr int inner = Layout<Dim>::inner, outer = Layout<Dim>::outer, across = 3 - inner - outer;
        return in_solids(flow, flow.solids, [&](int a, Offset c) {
            const CellNumber<Dim> n = flow.grid.layout().number(c);
            if (!flow.grid.has(n)) return Real(0);
            const RowRange& r = flow.faces[a].row(n[outer], Dim == 3 ? n[across] : 0);
            const auto mid = static_cast<Real>(mid_[a][c]);
            const bool moved = n[inner] >= r.begin && n[inner] < r.end;
            return moved ? (static_cast<Real>(scratch_[a][c]) - mid) * mid : 0;
        });
    }
    static Real share_of_boundary(const View& flow, int a, const CellNumber<Dim>& cell) noexcept {
        const auto open = [](Boundary side) { return side == Boundary::inflow || side == Boundary::outflow; };
        const auto& ends = flow.params.boundaries[a];
        return 1 +
               0.5 * ((cell[a] == 1 && open(ends[0])) + (cell[a] == flow.grid.cells(a) - 1 && open(ends[1])));
    }

    /// `viscosity` times dt [Pa s2]. The mean of both sides of a wall is the wall's velocity.
    Real work_of_sides(const View& flow, Real viscosity) const {
        if (!flow.params.boundary_velocity || flow.params.wall_law.kind != WallLaw::Kind::no_slip) return 0;
        Real work = 0;
        for (int b = 0; b < Dim; ++b)
            for (const bool high : {false, true}) {
                if (flow.params.boundaries[b][high] != Boundary::wall) continue;
                const Offset out = (high ? 1 : -1) * flow.grid.layout().stride[b];
                flow.grid.for_each_beside(b, high, [&](const CellNumber<Dim>& cell, Offset c) {
                    for (int a = 0; a < Dim; ++a) {
                        if (a == b || (cell[a] == 0 && !flow.params.boundaries.periodic(a))) continue;
                        if (content_.liquid_of_face(flow, a, c) == 0) continue;
                        const auto inside = static_cast<Real>(mid_[a][c]);
                        const Real wall = 0.5 * (inside + static_cast<Real>(mid_[a][c + out]));
                        const Real size = flow.grid.size(b, cell[b]);
                        work += 2 * (wall - inside) * wall / square(size) *
                                content_.control_volume_of(flow, a, c);
                    }
                });
            }
        return viscosity * work;
    }

    /// Work of velocities that faces gain, or lose, of which `each` tells.
    Real work_at_faces(const View& flow, auto&& each) const {
        std::unordered_map<Offset, Real> solid;
        const auto key = [](int a, Offset c) { return Dim * c + a; };
        for (const SolidVolume& s : flow.solids) solid[key(s.axis, s.face)] += s.volume;
        Real work = 0;
        each([&](int a, Offset c, Real gained) {
            if (gained == 0) return;
            const auto found = solid.find(key(a, c));
            const Real liquid =
                content_.liquid_of_face(flow, a, c) - (found == solid.end() ? 0 : found->second);
            const CellNumber<Dim> cell = flow.grid.layout().number(c);
            const auto mid = static_cast<Real>(mid_[a][c]), now = static_cast<Real>(flow.velocity[a][c]);
            work += share_of_boundary(flow, a, cell) * std::max(liquid, Real(0)) * gained *
                    (flow.liquid ? 0.5 * (mid + now) : mid);
        });
        return flow.params.density * work;
    }

    /// Potential energy and work of the pressure of water that is put in; what is taken out has its own
    /// motion, too.
    Real brought_by_sources(const View& flow) const {
        Real brought = 0;
        for (const CellSource& s : flow.sources) {
            if (s.volume == 0) continue;
            const Point<Dim> x = flow.grid.centre(flow.grid.layout().number(s.cell));
            Real squares = 0;
            for (int a = 0; a < Dim; ++a)
                for (const Offset c : {s.cell, s.cell + flow.grid.layout().stride[a]})
                    squares += 0.5 * square(static_cast<Real>(mid_[a][c]));
            brought += s.volume * (static_cast<Real>(flow.pressure[s.cell]) - content_.gravity().dot(x) +
                                   (s.volume < 0 ? 0.5 * squares : 0));
        }
        return flow.params.density * brought;
    }

    /// Led on to the face from two cells, if the second one is wet.
    static Real pressure_at(const View& flow, const BoundaryFace& o) noexcept {
        const Offset in = (o.high ? -1 : 1) * flow.grid.layout().stride[o.axis];
        const auto p = static_cast<Real>(flow.pressure[o.cell]);
        const bool two = flow.grid.cells(o.axis) > 1 && (!flow.wet || (*flow.wet)[o.cell + in] != 0);
        return two ? 1.5 * p - 0.5 * static_cast<Real>(flow.pressure[o.cell + in]) : p;
    }

    /// Books what went through; answers how much kinetic energy came in [J].
    Real through_boundary(const View& flow, WaterEnergy& change) const {
        Real carried = 0;
        for (const BoundaryFace& o : boundary_faces_) {
            if (o.volume == 0) continue;
            const CellNumber<Dim> cell = flow.grid.layout().number(o.cell);
            const Offset out = (o.high ? 1 : -1) * flow.grid.layout().stride[o.axis];
            Real squares = square(static_cast<Real>(mid_[o.axis][o.face(flow.grid)]));
            for (int a = 0; a < Dim; ++a)
                for (const int end : {0, 1}) {
                    const Offset c = o.cell + end * flow.grid.layout().stride[a];
                    if (a == o.axis) continue;
                    const Real twice = static_cast<Real>(mid_[a][c]) + static_cast<Real>(mid_[a][c + out]);
                    squares += 0.5 * square(0.5 * twice);
                }
            Point<Dim> x = flow.grid.centre(cell), along = content_.gravity();
            x[o.axis] = flow.grid.face(o.axis, cell[o.axis] + o.high);
            along[o.axis] = 0;
            const Real height = content_.gravity().dot(x) + content_.off_centre(flow, o.cell, along);
            const Real pressure = 0.5 * (o.pressure + pressure_at(flow, o));
            const Real mass = flow.params.density * (o.high ? -o.volume : o.volume);  // that came in
            const Real energy = mass * (0.5 * squares - height + pressure);
            carried += 0.5 * mass * squares;
            o.inflow ? change.inflow += energy : change.outflow -= energy;
        }
        return carried;
    }

    WaterContent<Dim, State, Liquid> content_;
    FaceField<Dim, State> mid_;      ///< the velocity that moves the water in the step [m/s]
    FaceField<Dim, State> scratch_;  ///< [m/s]
    FaceField<Dim, State> still_;    ///< 0: carries nothing
    std::vector<BoundaryFace> boundary_faces_;
    typename WallFriction<Dim>::PerFace taken_{};  ///< by walls in the step [m/s]
    WaterEnergy energy_;
};

}  // namespace abrade::detail
