#pragma once
// Watches a running invert channel: the ledger over time, and a series for ParaView.

#include "results.hpp"

#include <abrade/abrade.hpp>
#include <abrade/io/series.hpp>

#include <filesystem>

namespace abrade::examples {

class Recorder {
public:
    /// Writes the bodies at most every `every` [s]; `resumes`: its fields are read next.
    Recorder(const std::filesystem::path& stem, Real every, bool resumes)
        : series_(resumes ? SeriesWriter(stem, SeriesWriter::goes_on) : SeriesWriter(stem)), every_(every) {}

    template <class Sim>
    void operator()(const Sim& sim) {
        if (!history_.time.empty() && sim.time() <= history_.time.back()) return;  // a stop on an output time
        record_ledger(sim.ledger(), sim.time());
        if (sim.time() < next_ - 0.5 * sim.time_step()) return;
        next_ += every_;
        write_stones(sim.particles(), sim.time());
        write_concrete(sim);
    }

    LedgerHistory take_history() { return std::move(history_); }

    /// Before its fields are saved.
    void close_file() { series_.begin_file(); }
    static void fields(auto&& field) {
        field("series", &Recorder::series_), field("next", "s", &Recorder::next_),
            field("history", &Recorder::history_);
    }

private:
    void record_ledger(const Ledger& ledger, Real time) {
        std::size_t column = 0;
        ledger.visit([&](std::string_view name, Real value) {
            if (column == history_.names.size())
                history_.names.emplace_back(name), history_.values.emplace_back();
            history_.values[column++].push_back(value);
        });
        history_.time.push_back(time);
    }

    static void append(std::vector<Real>& column, const Vec3& v) {
        column.insert(column.end(), v.data(), v.data() + 3);
    }

    /// Member spheres of stones, so that a clump looks like what it is.
    void write_stones(const Particles& p, Real time) {
        std::vector<Real> centre, velocity, radius, id;
        for (Index s = 0; s < p.spheres(); ++s) {
            const auto i = static_cast<std::size_t>(s), b = static_cast<std::size_t>(p.body[i]);
            if (p.kind[b] != Kind::stone) continue;
            append(centre, p.centre[i]);
            append(velocity, p.velocity[b]);
            radius.push_back(p.radius[i]);
            id.push_back(p.id[b]);
        }
        const std::vector<FieldView> fields{
            {"radius", "m", 1, radius}, {"stone", "-", 1, id}, {"velocity", "m/s", 3, velocity}};
        series_.write("stones", time, {"position", "m", 3, centre}, fields);
    }

    /// Concrete still in the channel, standing, awake or not, or loose.
    template <class Sim>
    void write_concrete(const Sim& sim) {
        const Particles& p = sim.particles();
        const Concrete& concrete = sim.concrete();
        std::vector<Real> centre, velocity, fracture, kind;
        const auto add = [&](Index site, const Vec3& x, const Vec3& v, bool loose) {
            append(centre, x), append(velocity, v);
            fracture.push_back(concrete.fracture(site)), kind.push_back(loose);
        };
        std::vector<char> is_body(static_cast<std::size_t>(concrete.sites()), 0);
        for (Index b = 0; b < p.bodies(); ++b) {
            const auto i = static_cast<std::size_t>(b);
            if (p.site[i] < 0) continue;
            is_body[static_cast<std::size_t>(p.site[i])] = 1;
            add(p.site[i], p.position[i], p.velocity[i], p.kind[i] == Kind::grain);
        }
        for (Index site = 0; site < concrete.sites(); ++site)
            if (!is_body[static_cast<std::size_t>(site)] && !concrete.gone(site))
                add(site, sim.concrete_place(site), Vec3::Zero(), false);
        const std::vector<FieldView> fields{
            {"fracture_rate", "-", 1, fracture}, {"loose", "-", 1, kind}, {"velocity", "m/s", 3, velocity}};
        series_.write("concrete", sim.time(), {"position", "m", 3, centre}, fields);
    }

    SeriesWriter series_;
    Real every_, next_ = 0;  ///< [s]
    LedgerHistory history_;
};

}  // namespace abrade::examples
