#pragma once
// What a stone loses that falls on concrete, against how the concrete is cut and computed: part of
// wear_mesh.cpp.

#include "drops_on_slab.hpp"
#include "panels.hpp"

#include <nlohmann/json.hpp>

#include <iomanip>

namespace abrade::charts {

class DropChart {
public:
    DropChart(const std::filesystem::path& folder, int poses)
        : folder_(folder), runs_(folder / "wear_mesh_drops.csv"), poses_(poses) {}

    /// Prints the tables, draws the picture; returns what belongs in the summary.
    nlohmann::ordered_json make() {
        std::cout << "## Drops: share of its energy that a stone loses; 1 - e^2 = "
                  << 1 - square(Drop::restitution) << "\n\n";
        for (const Real stone : stones) table(StoneShape::sphere, stone, {0.5, 1, 2, 4});
        table(StoneShape::angular, 0.05, {2, 4});
        draw_shares();
        for (const auto& [ground, seconds] : runs_.seconds())
            std::cerr << "drops, " << ground << ": " << seconds << " s\n";
        std::cout << "\nlargest differences: dynamic x64 against static " << dynamic_ << ", static against "
                  << "rigid " << rigid_ << ", 0.01 m against 0.02 m " << size_ << " (sphere), "
                  << size_angular_ << " (angular), plane against 1 - e^2 " << plane_ << "\n";
        return {{"impact_loss_spread_relative", dynamic_},
                {"impact_loss_rigid_spread_relative", rigid_},
                {"impact_loss_size_spread_relative", size_},
                {"impact_loss_size_spread_angular_relative", size_angular_},
                {"impact_loss_plane_error_relative", plane_},
                {"impact_loss_poses", poses_}};
    }

private:
    static constexpr std::array<Real, 5> stones{0.02, 0.03, 0.05, 0.1, 0.15};  // [m]
    static constexpr std::array<Real, 3> sphere_diameters{0.01, 0.02, 0.04};   // [m]

    static const std::vector<Ground>& grounds() {
        static const std::vector<Ground> all{{"static"},
                                             {"rigid", ConcreteLevel::rigid},
                                             {"dynamic, bonds x64", ConcreteLevel::dynamic, 64},
                                             {"dynamic, bonds x1", ConcreteLevel::dynamic, 1},
                                             {"dynamic, bonds x1, dashpot", ConcreteLevel::dynamic, 1, true}};
        return all;
    }
    static const Ground& plane() {
        static const Ground wall{.title = "plane", .plane = true};
        return wall;
    }
    static Real mean(const std::vector<Real>& shares) {
        Real sum = 0;
        for (const Real share : shares) sum += share;
        return sum / static_cast<Real>(shares.size());
    }
    static Real standard_error(const std::vector<Real>& shares) {
        const Real middle = mean(shares), count = static_cast<Real>(shares.size());
        Real squares = 0;
        for (const Real share : shares) squares += square(share - middle);
        return std::sqrt(squares / (count - 1) / count);
    }
    static void raise(Real& largest, Real value) { largest = std::max(largest, std::abs(value)); }

    void table(StoneShape shape, Real stone, const std::vector<Real>& speeds) {
        std::cout << "| " << (shape == StoneShape::angular ? "angular, turned at random: " : "")
                  << "stone, speed | plane | concrete's spheres |";
        for (const Ground& ground : grounds()) std::cout << " " << ground.title << " |";
        std::cout << "\n|---|---|---|";
        for (std::size_t n = 0; n < grounds().size(); ++n) std::cout << "---|";
        std::cout << "\n" << std::setprecision(4);
        for (const Real speed : speeds) {
            const Real flat = mean(
                runs_.shares({.ground = plane(), .stone = stone, .speed = speed, .shape = shape}, poses_));
            if (shape == StoneShape::sphere) raise(plane_, flat / (1 - square(Drop::restitution)) - 1);
            std::array<Real, sphere_diameters.size()> standing{};
            for (std::size_t size = 0; size < sphere_diameters.size(); ++size) {
                const Real d = sphere_diameters[size];
                const bool gated = d < 0.03;
                std::cout << "| " << stone << " m, " << speed << " m/s | " << flat << " | " << d << " m |";
                std::vector<Real> first;
                for (const Ground& ground : grounds()) {
                    const std::vector<Real> shares = runs_.shares({ground, d, stone, speed, shape}, poses_);
                    std::cout << " " << mean(shares) << " +- " << std::setprecision(2)
                              << standard_error(shares) << std::setprecision(4) << " |" << std::flush;
                    if (first.empty()) first = shares;
                    if (ground.level == ConcreteLevel::rigid)
                        for (std::size_t n = 0; n < shares.size(); ++n)
                            raise(rigid_, shares[n] / first[n] - 1);
                    if (ground.bond_over_contact == 64 && gated)
                        raise(dynamic_, mean(shares) / mean(first) - 1);
                }
                standing[size] = mean(first);
                std::cout << "\n";
            }
            raise(shape == StoneShape::sphere ? size_ : size_angular_, standing[0] / standing[1] - 1);
        }
        std::cout << "\n";
    }

    void draw_shares() {
        PanelChart chart{.title = "Share of its energy that a sphere loses at 2 m/s, e = 0.6",
                         .x = {.label = "diameter of the stone", .unit = "mm", .min = 0.0, .max = 160},
                         .y = {.label = "share lost in impacts", .unit = "-", .min = 0.0, .max = 0.8},
                         .columns = 3,
                         .panel_width = 420};
        std::vector<Ground> drawn = grounds();
        drawn.erase(drawn.begin() + 1);  // rigid, on the same line
        drawn.push_back(plane());
        for (const Ground& ground : drawn) chart.names.push_back(ground.title);
        chart.names.front() = "static and rigid";
        for (const Real d : sphere_diameters) {
            Panel& panel = chart.panels.emplace_back();
            panel.title = "concrete's spheres " + to_text(1e3 * d) + " mm";
            for (const Ground& ground : drawn) {
                Curve& curve = panel.curves.emplace_back();
                for (const Real stone : stones) {
                    curve.x.push_back(1e3 * stone);
                    curve.y.push_back(mean(runs_.shares({ground, d, stone, 2}, poses_)));
                }
            }
        }
        draw(chart, folder_ / "wear_mesh_drops.png");
    }

    using Curve = examples::Curve;

    std::filesystem::path folder_;
    DropRuns runs_;
    int poses_ = 50;
    Real dynamic_ = 0, rigid_ = 0, size_ = 0, size_angular_ = 0, plane_ = 0;  ///< largest, relative
};

}  // namespace abrade::charts
