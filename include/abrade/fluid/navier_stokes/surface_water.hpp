#pragma once
// Water below a free surface: where it is, what it touches, and the advecting flux of its momentum.

#include <abrade/fluid/embedded_boundary/closed_faces.hpp>
#include <abrade/fluid/embedded_boundary/open_friction.hpp>
#include <abrade/fluid/embedded_boundary/wall_friction.hpp>
#include <abrade/fluid/height/height_of_fluid.hpp>
#include <abrade/fluid/navier_stokes/film_clamp.hpp>
#include <abrade/fluid/navier_stokes/initial_condition.hpp>
#include <abrade/fluid/navier_stokes/momentum_faces.hpp>
#include <abrade/fluid/navier_stokes/open_faces.hpp>
#include <abrade/fluid/navier_stokes/velocity_extension.hpp>
#include <abrade/fluid/pressure/projection.hpp>
#include <abrade/fluid/setup/grid_fluid_params.hpp>
#include <abrade/fluid/vof/volume_of_fluid.hpp>

#include <cstring>
#include <memory>
#include <utility>

namespace abrade::detail {

/// What GridFluid knows of its liquid beside velocity and pressure.
template <int Dim, class Liquid = VolumeOfFluid<Dim>>
class SurfaceWater {
    static constexpr bool is_height = std::same_as<Liquid, HeightOfFluid<Dim>>;
    static constexpr int vertical = Grid<Dim>::vertical;

public:
    SurfaceWater(const Grid<Dim>& grid, const GridFluidParams<Dim>& params)
        : grid_(&grid), boundaries_(params.boundaries),
          liquid_(grid, params.boundaries, liquid_params(params)), walls_(walls_inside(grid, params)),
          films_(grid, params.boundaries, walls_.get(), params.gravity.norm()),
          friction_(grid, params.boundaries, params.wall_law, walls_.get()), before_(grid.layout().total),
          flux_(face_field<Dim>(grid.layout())), surface_push_(face_field<Dim>(grid.layout())),
          wet_(grid.layout().total), rows_(WetRows<Dim>::whole(grid.layout())),
          extension_(grid.layout(), boundaries_), open_(grid, walls_.get()) {
        for (auto& f : faces_) f = WetRows<Dim>(grid.layout());
        if (boundaries_.periodic(vertical))
            fail({"GridFluid.boundaries.z", "not periodic where there is a surface", "",
                  "close the floor, or take a FullBox"},
                 "periodic");
        liquid_.set_gravity(params.gravity);
        if (walls_) {
            if constexpr (is_height)
                liquid_.set_walls(*walls_);
            else
                liquid_.set_walls(&walls_->aperture(), &walls_->open_fraction());
            extension_.set_walls(*walls_);
            liquid_fraction_ = Field<Real>(layout().total);
            open_friction_ = open_friction_of(*walls_, boundaries_);
            closed_faces_ = {*walls_, boundaries_};
        }
        give_water(params, walls_.get(), liquid_);
        if constexpr (is_height) liquid_.begin(params.water);
        settle();
    }

    const Liquid& liquid() const noexcept { return liquid_; }
    const EmbeddedBoundary<Dim>* walls() const noexcept { return walls_.get(); }
    /// Liquid in each cell, as a share of the whole cell [-]: now, and when the step began.
    const Field<Real>& liquid_fraction() const noexcept {
        return walls_ ? liquid_fraction_ : liquid_.fraction();
    }
    const Field<Real>& liquid_fraction_before() const noexcept { return before_; }
    /// See MomentumStage.
    const PerAxis<FaceField<Dim, float>, Dim>* open_friction() const noexcept {
        return walls_ ? &open_friction_ : nullptr;
    }
    const FaceField<Dim>* aperture() const noexcept { return walls_ ? &walls_->aperture() : nullptr; }
    /// Liquid, and solids among it, that went through each face in the step; from `carry_by` on what carries
    /// momentum in its second stage [m3].
    const FaceField<Dim>& flux() const noexcept { return flux_; }
    const PerAxis<WetRows<Dim>, Dim>& faces() const noexcept { return faces_; }  ///< that carry momentum
    const Field<std::uint8_t>& wet() const noexcept { return wet_; }  ///< 1 where the pressure is unknown
    /// Faces of wet cells to cells that are dry for their wall alone: they move as what is beside them did.
    std::span<const WaterFace> still() const noexcept { return open_.still(); }
    const WallFriction<Dim>& friction() const noexcept { return friction_; }
    const WetRows<Dim>& rows() const noexcept { return rows_; }

    /// Copies to beyond periodic sides.
    void join(auto& field) const noexcept { fill_periodic(field, layout(), boundaries_); }

    void set_solids(std::span<const SolidPart> parts, std::span<const SolidFlux> fluxes) {
        liquid_.set_solids(parts, fluxes);
    }
    void stand_solids(std::span<const SolidPart> parts) {
        liquid_.stand_solids(parts);
        find_rows(), find_liquid_fraction();
    }
    void take_back_solids() { liquid_.take_back_solids(); }

    /// Moves the liquid with the velocity over a step; sources are told what cells got of them.
    void move(const FaceField<Dim>& velocity, Real step, std::span<CellSource> sources) {
        rows_.copy(liquid_fraction(), before_);
        join(before_);
        liquid_.advance(velocity, step, flux_, sources);
        rows_before_ = rows_;
        find_rows();
        find_liquid_fraction();
        join(flux_);
        find_air();
    }

    /// The second stage's flux: see `carry_bulk_by`.
    void carry_by(const FaceField<Dim>& stage, Real step) {
        carry_bulk_by(stage, *grid_, rows_, {step, before_, liquid_fraction(), liquid_.full()}, flux_);
        join(flux_);
    }

    /// Which cells are wet below the present surface and where it crosses the lines between centres; takes
    /// the pressure from dry cells.
    template <class Projects, class Solids = const NoSolids>
    void find(Projects& projection, Field<Real>& pressure, Solids& solids = no_solids) {
        WetRows<Dim> rows = rows_;
        rows.include(rows_before_);
        const Field<Real>& f = liquid_.fraction();
        rows.for_each_row([&](int plane, int row, const RowRange& r) {
            const Offset start = layout().row_start(plane, row);
            const Real* const __restrict liquid = f.data() + start;
            const Real* const __restrict room = walls_ ? walls_->open_fraction().data() + start : liquid;
            std::uint8_t* const __restrict wet = wet_.data() + start;
            Real* const __restrict p = pressure.data() + start;
#pragma omp simd
            for (int i = r.begin; i < r.end; ++i) {
                const Real is_wet =
                    (liquid[i] >= 0.5 ? Real(1) : Real(0)) * (room[i] > 0 ? Real(1) : Real(0));
                wet[i] = static_cast<std::uint8_t>(is_wet);
                p[i] *= is_wet;
            }
        });
        if (walls_)
            parallel_for(liquid_.planes().count(), [&](Index i) {
                const Index c = liquid_.planes().cell[static_cast<std::size_t>(i)];
                wet_[c] = liquid_.is_liquid(c) && is_open(c);
                if (!wet_[c]) pressure[c] = 0;
            });
        join(wet_);
        open_.find(liquid_, wet_, rows_, projection.outflows(wet_));
        projection.set({wet_, rows, open_.open(), room(), aperture()}, solids);
        find_air();
    }

    /// Around a stage of momentum: see ClosedFaces.
    void fill_closed(FaceField<Dim>& u) const {
        closed_faces_.fill(u, liquid_fraction_before(), liquid_fraction());
    }
    void clear_closed(FaceField<Dim>& u) const { closed_faces_.clear(u); }

    /// Nothing falls through walls.
    void clear_walls(FaceField<Dim>& u) const {
        if (walls_)
            grid_->for_each([&](const CellNumber<Dim>&, Offset c) {
                for (int a = 0; a < Dim; ++a) u[a][c] *= walls_->aperture()[a][c] > 0;
            });
        for (const WaterFace& f : still()) u[f.axis][f.face] = 0;
    }
    /// Nothing falls where there is no water: friction of walls would take its part of that.
    void clear_air(FaceField<Dim>& u) const {
        grid_->for_each([&](const CellNumber<Dim>&, Offset c) {
            for (int a = 0; a < Dim; ++a)
                if ((wet_[c] | wet_[c - layout().stride[a]]) == 0) u[a][c] = 0;
        });
    }

    /// At the surface the pressure falls to 0 within another distance than that of the centres: what that
    /// changes in a step [m/s].
    void find_surface_push(std::span<const OpenFace> open_faces, const Field<Real>& pressure, Real step,
                           const Point<Dim>& gravity) {
        parallel_for(static_cast<Index>(open_faces.size()), [&](Index n) {
            const OpenFace& open = open_faces[static_cast<std::size_t>(n)];
            if (open.plain != 0)
                surface_push_[open.axis][open.face] =
                    -step * ((open.slope - open.plain) * pressure[open.cell] +
                             (1 - open.weight) * gravity[open.axis]);
        });
    }
    void clear_surface_push(std::span<const OpenFace> open_faces) {
        for (const OpenFace& open : open_faces) surface_push_[open.axis][open.face] = 0;
    }
    const FaceField<Dim>& surface_push() const noexcept { return surface_push_; }

    /// Velocities of the air beside the water, and of films.
    void extend(FaceField<Dim>& u) {
        extension_.clear_left(u, rows_before_, rows_);
        extension_.extend(u);
        if constexpr (is_height)
            liquid_.clamp_films(u);
        else
            films_.hold(u, rows_, wet_, liquid_fraction());
    }

    /// What walls take in a step, of what is given to the liquid in the air, too.
    auto slow(FaceField<Dim>& u, Real step, Real viscosity) {
        typename WallFriction<Dim>::PerFace taken;
        of_its_own(u, [&] { taken = friction_.apply(u, &rows_, step, viscosity); });
        return taken;
    }
    /// Calls act() while slaved faces have what the liquid in the air has of its own.
    void of_its_own(FaceField<Dim>& u, auto&& act) {
        extension_.add_to_own(u, -1);
        act();
        extension_.add_to_own(u, 1);
    }

    /// In a step's second stage: in the first one the old pressure pushed master faces. The new one is yet to
    /// push them, so slaved faces begin with what they had of their own there: what flowed to them, and its
    /// fall.
    void let_go(FaceField<Dim>& velocity) const { extension_.give_own(velocity); }

    /// After `find`, before the pressure is: see detail::load_masters.
    void load_masters(FaceField<Dim>& velocity, const Field<std::uint8_t>& was_wet) {
        detail::load_masters(velocity, extension_, *grid_, liquid_fraction(), was_wet);
    }

    /// To the bit.
    bool has_walls_of(const SurfaceWater& other) const {
        if (!walls_ || !other.walls_) return walls_ == other.walls_;
        const auto same = [](const Field<Real>& a, const Field<Real>& b) {
            return std::memcmp(a.data(), b.data(), sizeof(Real) * static_cast<std::size_t>(a.size())) == 0;
        };
        bool all = same(walls_->open_fraction(), other.walls_->open_fraction());
        for (int a = 0; a < Dim; ++a) all = all && same(walls_->aperture()[a], other.walls_->aperture()[a]);
        return all;
    }

    /// After walls have changed around the water.
    void make_room() {
        if constexpr (!is_height) liquid_.make_room(flux_);
        rows_before_.include(rows_);
        find_rows(), find_liquid_fraction();
    }

    /// Puts back fractions and volume defects as they were saved, in the rows of then, after so many steps.
    void restore(const Field<Real>& fraction, const Field<Real>& volume_defect, const WetRows<Dim>& rows,
                 Index steps) {
        liquid_.set_steps(steps);
        rows_.for_each_row([&](int plane, int row, const RowRange& r) {
            std::fill_n(liquid_.fraction().data() + layout().row_start(plane, row) + r.begin, r.length(), 0);
        });
        rows.copy(fraction, liquid_.fraction());
        Field<Real> kept = liquid_.volume_defect();
        settle();
        rows_before_.include(rows);  // what they hold more than now, water has left
        rows.for_each_row([&](int plane, int row, const RowRange& r) {  // of what it has closed as well
            const Offset start = layout().row_start(plane, row);
            for (Offset c = start + r.begin; c < start + r.end; ++c)
                kept[c] = volume_defect[c] + (fraction[c] - liquid_.fraction()[c]);
        });
        liquid_.volume_defect() = std::move(kept);
        if constexpr (is_height) liquid_.gather(), find_rows(), find_liquid_fraction();
    }

    static void fields(auto&& field) {
        field("liquid", &SurfaceWater::liquid_), field("liquid_fraction", &SurfaceWater::liquid_fraction_),
            field("before", &SurfaceWater::before_), field("wet", &SurfaceWater::wet_),
            field("rows", &SurfaceWater::rows_), field("rows_before", &SurfaceWater::rows_before_),
            field("faces", &SurfaceWater::faces_), field("extension", &SurfaceWater::extension_),
            field("flux", "m3", &SurfaceWater::flux_), field("open", &SurfaceWater::open_);
    }
    /// The pressure's operator, of what has been found; nothing stays of what it was before.
    void show(auto& projection) const {
        WetRows<Dim> rows = rows_;
        rows.include(rows_before_);
        for (const WetRows<Dim>& all : {WetRows<Dim>::whole(layout()), rows})
            projection.set({wet_, all, open_.open(), room(), aperture()});
    }

private:
    static typename Liquid::Params liquid_params(const GridFluidParams<Dim>& params) {
        if constexpr (is_height) {
            return {.steepest = params.steepest_surface, .most_overturning = params.most_overturning};
        } else {
            // Air of less than a millionth would tilt a surface by what round-off makes of it.
            const auto within = [&](Real least) { return std::clamp(params.tolerance, least, Real(1e-4)); };
            return {.courant = std::max(0.5, params.courant),
                    .smallest_void = within(1e-6),
                    .largest_volume_defect = 10 * within(1e-8)};
        }
    }
    const Layout<Dim>& layout() const noexcept { return grid_->layout(); }
    /// Of cells, in shares of which the liquid's volume defect is told; none: all.
    const Field<Real>* room() const noexcept {
        if constexpr (!is_height) return liquid_.room();
        return walls_ ? &walls_->open_fraction() : nullptr;
    }
    bool is_open(Offset c) const noexcept { return !walls_ || walls_->open_fraction()[c] > 0; }
    void find_air() { extension_.find({wet_, rows_, liquid_fraction(), still()}); }

    void settle() {
        liquid_.prepare();
        rows_before_ = rows_;
        find_rows(), find_liquid_fraction();
    }
    void find_liquid_fraction() {
        if (!walls_) return;
        WetRows<Dim> rows = rows_;
        rows.include(rows_before_);
        rows.for_each_row([&](int plane, int row, const RowRange& r) {
            const Offset start = layout().row_start(plane, row);
            const Real* const __restrict f = liquid_.fraction().data() + start;
            const Real* const __restrict v = walls_->open_fraction().data() + start;
            Real* const __restrict liquid_fraction = liquid_fraction_.data() + start;
            for (int i = r.begin; i < r.end; ++i) liquid_fraction[i] = f[i] * v[i];
        });
        join(liquid_fraction_);
    }

    /// Rows that hold water and what is near, and faces that carry momentum.
    void find_rows() {
        rows_ = liquid_.wet().dilated(VelocityExtension<Dim>::layers, boundaries_.periodic_axes());
        find_momentum_faces(liquid_.wet(), layout(), boundaries_, faces_);
    }

    const Grid<Dim>* grid_;
    BoundaryConditions<Dim> boundaries_;
    Liquid liquid_;
    std::shared_ptr<const EmbeddedBoundary<Dim>> walls_;  ///< shared among copies; the liquid points to them
    FilmClamp<Dim> films_;
    WallFriction<Dim> friction_;
    PerAxis<FaceField<Dim, float>, Dim> open_friction_;  ///< of sides of momentum's control volumes
    ClosedFaces<Dim> closed_faces_;
    Field<Real> liquid_fraction_, before_;
    FaceField<Dim> flux_;
    /// Of a face, within a step [m/s].
    FaceField<Dim> surface_push_;
    Field<std::uint8_t> wet_;
    WetRows<Dim> rows_, rows_before_;
    PerAxis<WetRows<Dim>, Dim> faces_;
    VelocityExtension<Dim> extension_;
    OpenFaces<Dim> open_;
};

}  // namespace abrade::detail
