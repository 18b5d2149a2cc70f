#pragma once
// The normal of the surface in each cell that it cuts.

#include <abrade/core/parallel.hpp>
#include <abrade/fluid/vof/plane_fit.hpp>

namespace abrade {

/// Reconstruction of the surface by planes. Exact for a planar surface of any tilt, beside sides and walls
/// too.
///
/// Away from them: height functions. The liquid of a column of up to 7 cells, 3 near sides and walls, along
/// the axis that lies nearest to the normal is its height S; with complete columns (full at one end, dry at
/// the other) on both sides
///   dS/dt = [S(t + 1) - S(t - 1)] / 2,
/// which is second order, and exact where the surface is a plane. Where a column is not complete, and in the
/// cells beside sides and walls, `VolumeFit` takes over.
template <int Dim>
class SurfaceNormals {
public:
    SurfaceNormals() = default;
    SurfaceNormals(const Layout<Dim>& layout, const CellSizes<Dim>& sizes)
        : layout_(layout), sizes_(sizes), stencil_(layout), fit_(layout, sizes) {}

    /// Fills in distances and positions of planes whose cells are set, and their normals where they have
    /// none. Not `exact`: where heights are not known normals follow the gradient, at a tenth of what the fit
    /// costs.
    void find(SurfacePlanes<Dim>& planes, const Real* fraction, const std::uint8_t* marks, bool exact) const {
        parallel_blocks(planes.count(), [&](Index, Index first, Index last) {
            Block block(*this, planes, fraction, marks);
            block.sort(first, last);
            for (int way = 0; way < 2 * Dim; ++way)
                for (const bool deep : {false, true}) block.heights(way, deep);
            block.fit(exact);
            block.place();
        });
    }

private:
    using PackCells = detail::PackCells;
    static constexpr int vertical = Grid<Dim>::vertical;
    static std::size_t at(int i) noexcept { return static_cast<std::size_t>(i); }

    /// Cells that are treated alike.
    struct List {
        std::array<Index, block_size> item;
        int count = 0;
        void add(Index i) noexcept { item[at(count++)] = i; }
    };

    /// A block of planes: small enough for its lists to stand in cache.
    struct Block {
        Block(const SurfaceNormals& owner, SurfacePlanes<Dim>& all, const Real* f, const std::uint8_t* m)
            : self(owner), planes(all), fraction(f), marks(m) {}

        const SurfaceNormals& self;
        SurfacePlanes<Dim>& planes;
        const Real* fraction;
        const std::uint8_t* marks;
        std::array<std::array<List, 2 * Dim>, 2> ways{};  ///< [deep][2 axis + (air above)]
        List rest{}, kept{};

        /// A pack of a list, its last item repeated.
        static std::array<Index, pack_lanes> items(const List& list, int first) noexcept {
            std::array<Index, pack_lanes> result;
            for (int lane = 0; lane < pack_lanes; ++lane)
                result[at(lane)] = list.item[at(std::min(first + lane, list.count - 1))];
            return result;
        }
        PackCells cells(const std::array<Index, pack_lanes>& item) const noexcept {
            PackCells result;
            for (std::size_t lane = 0; lane < result.size(); ++lane)
                result[lane] = planes.cell[static_cast<std::size_t>(item[lane])];
            return result;
        }
        PackCells levels(const std::array<Index, pack_lanes>& item) const noexcept {
            PackCells result;
            for (std::size_t lane = 0; lane < result.size(); ++lane)
                result[lane] = planes.level[static_cast<std::size_t>(item[lane])];
            return result;
        }

        void keep(const std::array<Index, pack_lanes>& item, int lanes, const std::array<Pack, Dim>& normal,
                  const Pack& distance) noexcept {
            for (int lane = 0; lane < lanes; ++lane) {
                const auto i = static_cast<std::size_t>(item[at(lane)]);
                for (std::size_t a = 0; a < Dim; ++a) planes.normal[a][i] = normal[a][lane];
                planes.distance[i] = planes.position[i] = distance[lane];
            }
        }

        /// Which axis lies nearest to the normal, and on which side the air is.
        void sort(Index first, Index last) noexcept {
            List regular;
            for (Index i = first; i < last; ++i) {
                const auto k = static_cast<std::size_t>(i);
                const bool ringed = (marks[planes.cell[k]] & cell_mark::ringed) != 0;
                (planes.has_normal[k] != 0 ? kept : ringed ? regular : rest).add(i);
            }
            for (int i = 0; i < regular.count; i += pack_lanes) {
                const auto item = items(regular, i);
                const PackCells cell = cells(item);
                std::array<Pack, Dim> g;
                g.fill(Pack(0));
                // Rows of the stencil: three neighbours along the inner axis at once.
                constexpr int inner = Layout<Dim>::inner;
                for (int p = -1; p <= 1; ++p)
                    for (int r = -1; r <= 1; ++r) {
                        if (Dim == 2 && r != 0) continue;
                        const Offset step = p * self.layout_.stride[0] +
                                            (Dim == 3 ? r * self.layout_.stride[Dim - 1] : 0) - 1;
                        const QuadColumns f = detail::gather_row(fraction, cell, step);
                        const Pack row = f[0] + f[1] + f[2];
                        g[inner] += f[2] - f[0];
                        if (p != 0) g[0] += p > 0 ? row : -row;
                        if (Dim == 3 && r != 0) g[Dim - 1] += r > 0 ? row : -row;
                    }
                for (int lane = 0; lane < std::min(pack_lanes, regular.count - i); ++lane) {
                    int axis = vertical;  // where all are alike
                    for (int a = 0; a < Dim; ++a)
                        if (std::abs(g[at(a)][lane]) > std::abs(g[at(axis)][lane])) axis = a;
                    const bool deep = (marks[cell[at(lane)]] & cell_mark::deep(axis)) != 0;
                    ways[deep][at(2 * axis + (g[at(axis)][lane] <= 0))].add(item[at(lane)]);
                }
            }
        }

        struct Column {
            Pack amount;
            PackMask complete;
        };
        /// Of the cells of a column, in the height of the middle one.
        struct Heights {
            std::array<Pack, 7> height{};
            bool stretched = false;
            int reach = 3;  ///< cells to each side of the middle
        };

        /// Liquid of the columns that stand `step` aside. `air` leads one cell towards the air. Cells that
        /// are nearly full or dry end a column but count as they are: a plane that cuts off less than a
        /// thousandth of a cell cuts no cell beyond it.
        Column column(const PackCells& cell, Offset step, Offset air, const Heights& heights) const noexcept {
            const auto& [height, stretched, reach] = heights;
            const Pack dry = Pack(1e-3), full = Pack(1 - 1e-3);
            const Pack own = detail::values_at(fraction, cell, step);
            Pack amount = own;
            PackMask to_air = own > dry, to_liquid = own < full;
            for (int k = 1; k <= reach; ++k) {
                if (any(to_air)) {
                    const Pack f = detail::values_at(fraction, cell, step + k * air);
                    const Pack part = stretched ? f * height[at(3 + k)] : f;
                    amount += select(to_air, part, Pack(0));
                    to_air = to_air & (f > dry);
                }
                if (any(to_liquid)) {
                    const Pack f = detail::values_at(fraction, cell, step - k * air);
                    const Pack whole = stretched ? height[at(3 - k)] : Pack(1);
                    amount += select(to_liquid, f * whole, whole);
                    to_liquid = to_liquid & (f < full);
                } else {
                    amount += stretched ? height[at(3 - k)] : Pack(1);
                }
            }
            return {amount, !(to_air | to_liquid)};
        }

        void heights(int way, bool deep) noexcept {
            const int axis = way / 2;
            const Real out = way % 2 == 0 ? -1 : 1;  // where the air is
            const Offset air = (way % 2 == 0 ? -1 : 1) * self.layout_.stride[at(axis)];
            const bool stretched = !self.sizes_.uniform();
            const List& list = ways[deep][at(way)];
            for (int i = 0; i < list.count; i += pack_lanes) {
                const auto item = items(list, i);
                const PackCells cell = cells(item);
                Heights heights{.stretched = stretched && axis == vertical, .reach = deep ? 3 : 1};
                auto& height = heights.height;
                std::array<Pack, 2> gap{Pack(1), Pack(1)};  // to the levels below and above
                height.fill(Pack(1));
                if (stretched)
                    for (int lane = 0; lane < pack_lanes; ++lane) {
                        const Index level = planes.level[static_cast<std::size_t>(item[at(lane)])];
                        const Real own = self.sizes_.edge(vertical, level);
                        // Beside sides there are no levels farther than the column reaches.
                        for (int k = -heights.reach; k <= heights.reach && axis == vertical; ++k)
                            height[at(3 + k)].set(
                                lane, self.sizes_.edge(vertical, level + (out > 0 ? k : -k)) / own);
                        gap[0].set(lane, self.sizes_.gap(level) / own);
                        gap[1].set(lane, self.sizes_.gap(level + 1) / own);
                    }
                std::array<Pack, Dim> normal;
                normal[at(axis)] = Pack(out);
                PackMask complete = Pack(0) < Pack(1);
                for (int t = 0; t < Dim; ++t) {
                    if (t == axis) continue;
                    const Offset step = self.layout_.stride[at(t)];
                    const Column low = column(cell, -step, air, heights);
                    const Column high = column(cell, step, air, heights);
                    complete = complete & low.complete & high.complete;
                    const Pack apart = t == vertical ? gap[0] + gap[1] : Pack(2);
                    normal[at(t)] = (low.amount - high.amount) / apart;
                }
                const Pack distance = plane_distance<Dim>(normal, detail::values_at(fraction, cell));
                const int lanes = std::min(pack_lanes, list.count - i);
                keep(item, lanes, normal, distance);
                const unsigned found = lanes_of(complete);
                for (int lane = 0; lane < lanes; ++lane)
                    if ((found >> lane & 1) == 0) rest.add(item[at(lane)]);
            }
        }

        /// Planes that keep their normal.
        void place() noexcept {
            for (int i = 0; i < kept.count; i += pack_lanes) {
                const auto item = items(kept, i);
                const std::array<Pack, Dim> normal = normal_of(item);
                const Pack distance = plane_distance<Dim>(normal, detail::values_at(fraction, cells(item)));
                for (int lane = 0; lane < std::min(pack_lanes, kept.count - i); ++lane) {
                    const auto k = static_cast<std::size_t>(item[at(lane)]);
                    planes.distance[k] = planes.position[k] = distance[lane];
                }
            }
        }
        std::array<Pack, Dim> normal_of(const std::array<Index, pack_lanes>& item) const noexcept {
            std::array<Pack, Dim> normal;
            for (std::size_t a = 0; a < Dim; ++a)
                normal[a] = detail::values_at(planes.normal[a].data(), item);
            return normal;
        }

        void fit(bool exact) noexcept {
            if (!exact) return fit(rest, {.attempts = 0});
            // Most are found soon; those that are not go on in packs of their own.
            List unsettled;
            fit(rest, {.attempts = 3, .unsettled = &unsettled});
            fit(unsettled, {.attempts = 7, .goes_on = true});
        }
        struct Round {
            int attempts;
            bool goes_on = false;       ///< from the normals that there are
            List* unsettled = nullptr;  ///< gets cells whose attempts did not do
        };
        void fit(const List& list, const Round& round) noexcept {
            for (int i = 0; i < list.count; i += pack_lanes) {
                const auto item = items(list, i);
                const PackCells cell = cells(item);
                const auto from = normal_of(item);
                const auto found = self.fit_.find(round.attempts, fraction, marks, cell_mark::whole, cell,
                                                  levels(item), round.goes_on ? &from : nullptr);
                const int lanes = std::min(pack_lanes, list.count - i);
                keep(item, lanes, found.normal,
                     plane_distance<Dim>(found.normal, detail::values_at(fraction, cell)));
                if (!round.unsettled) continue;
                const unsigned left = lanes_of(found.unsettled);
                for (int lane = 0; lane < lanes; ++lane)
                    if (left >> lane & 1) round.unsettled->add(item[at(lane)]);
            }
        }
    };

    Layout<Dim> layout_{};
    CellSizes<Dim> sizes_{};
    detail::Stencil<Dim> stencil_{};
    VolumeFit<Dim> fit_{};
};

}  // namespace abrade
