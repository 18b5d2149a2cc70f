#pragma once
// The equilibrium of a few rigid members on springs, some of which are frictional contacts.

#include <abrade/bond/bond_law.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

namespace abrade {

/// What a member feels, or how it gives way: a force [N] and a torque over the size r [N]; a way [m] and a
/// turn times r [m].
struct Screw {
    Vec3 along = Vec3::Zero(), about = Vec3::Zero();
};

/// The springs of a bond between member a and member b, or what stands (b < 0). A bond that is broken carries
/// what presses it: f_n >= 0, |f_s| <= mu f_n.
struct StandingLink {
    enum class Grip : std::uint8_t { sticks, slips, open };

    Index a = 0, b = -1;
    Vec3 normal = Vec3::UnitZ();                      ///< unit, from b to a
    Vec3 arm_a = Vec3::Zero(), arm_b = Vec3::Zero();  ///< from the members' centres to the contact point [m]
    BondRigidity k{};
    bool sound = true;
    Index number = -1;  ///< the caller's

    // as solved
    Vec3 displacement = Vec3::Zero();  ///< of a relative to b at the contact point [m]
    Vec3 rotation = Vec3::Zero();      ///< likewise [rad]
    Grip grip = Grip::sticks;
    Vec3 slip = Vec3::Zero();  ///< friction on a where it slips [N]

    Real compression() const noexcept { return -displacement.dot(normal); }
    Vec3 shear() const noexcept { return displacement + compression() * normal; }
};

/// K q = Q for members that turn and shift by little: 6 unknowns each, q = (u, r theta), and the springs' way
/// at their contact points
///   d = (u_a + theta_a x p_a) - (u_b + theta_b x p_b),  f_n = -k_n d.n,  f_s = -k_s (d - (d.n) n).
/// Which broken bonds stick, slip or open is found by trying.
class Equilibrium {
public:
    std::vector<StandingLink> links;
    std::vector<Screw> load;  ///< [member]

    /// r is the members' size [m], mu the friction of broken bonds [-].
    Equilibrium(Real size, Real friction) : size_(size), friction_(friction) {}

    void begin(Index members) {
        links.clear();
        load.assign(static_cast<std::size_t>(members), {});
    }

    /// Finds ways and grips. False where nothing holds a member: it would come `most` [m] or farther.
    bool solve(Real most) {
        constexpr int tries = 60;
        for (StandingLink& link : links) link.grip = StandingLink::Grip::sticks, link.slip.setZero();
        for (int n = 0; n < tries; ++n) {
            respond_to(load);
            const bool settled = !regrip();
            if (settled) break;
        }
        return furthest() < most;
    }

    /// How far the given link gives way for a unit load of member 0 in each of its six directions, as
    /// magnitudes over all directions: stretch, shear, bend, twist [m/N], [rad/N]. Of sticking links.
    std::array<Real, 4> compliance(std::size_t link) const noexcept { return compliance_[link]; }
    void find_compliance() {
        compliance_.assign(links.size(), {});
        const std::vector<Screw> given = load;
        for (int axis = 0; axis < 6; ++axis) {
            std::fill(load.begin(), load.end(), Screw{});
            (axis < 3 ? load[0].along : load[0].about)[axis % 3] = 1;
            axis == 0 ? respond_to(load) : respond_again(load);
            for (std::size_t l = 0; l < links.size(); ++l) {
                const StandingLink& link = links[l];
                const Real twist = link.rotation.dot(link.normal);
                compliance_[l][0] += square(link.compression());
                compliance_[l][1] += link.shear().squaredNorm();
                compliance_[l][2] += (link.rotation - twist * link.normal).squaredNorm();
                compliance_[l][3] += square(twist);
            }
        }
        for (auto& all : compliance_)
            for (Real& one : all) one = std::sqrt(one);
        load = given;
    }

private:
    static std::size_t at(Index i) noexcept { return static_cast<std::size_t>(i); }
    std::size_t unknowns() const noexcept { return 6 * load.size(); }
    Real& k(std::size_t i, std::size_t j) noexcept { return matrix_[i * unknowns() + j]; }

    /// d over the unknowns of a member whose contact point is at `arm`: three rows of six.
    using Rows = std::array<std::array<Real, 6>, 3>;
    Rows rows_of(const Vec3& arm, Real sign) const noexcept {
        const Vec3 p = sign / size_ * arm;
        return {
            {{sign, 0, 0, 0, p.z(), -p.y()}, {0, sign, 0, -p.z(), 0, p.x()}, {0, 0, sign, p.y(), -p.x(), 0}}};
    }

    /// Adds J_1^T D J_2 of a link to the block of its members.
    void add(std::size_t first, const Rows& one, std::size_t second, const Rows& two, const Mat3& springs,
             const Mat3& turning, Real sign) {
        for (std::size_t i = 0; i < 6; ++i)
            for (std::size_t j = 0; j < 6; ++j) {
                Real sum = 0;
                for (int a = 0; a < 3; ++a)
                    for (int b = 0; b < 3; ++b)
                        sum += one[static_cast<std::size_t>(a)][i] * springs(a, b) *
                               two[static_cast<std::size_t>(b)][j];
                if (i >= 3 && j >= 3) sum += sign * turning(static_cast<int>(i) - 3, static_cast<int>(j) - 3);
                k(6 * first + i, 6 * second + j) += sum;
            }
    }

    void assemble() {
        using Grip = StandingLink::Grip;
        const std::size_t n = unknowns();
        matrix_.assign(n * n, 0);
        Real stiffest = tiny<Real>;
        for (const StandingLink& link : links) {
            stiffest = std::max(stiffest, link.k.normal);
            if (link.grip == Grip::open) continue;
            const Mat3 along = link.normal * link.normal.transpose(), across = Mat3::Identity() - along;
            const Mat3 springs =
                link.k.normal * along + (link.grip == Grip::sticks ? link.k.tangential : 0) * across;
            Mat3 turning = Mat3::Zero();
            if (link.sound) turning = (link.k.bending * across + link.k.twisting * along) / square(size_);
            const Rows a = rows_of(link.arm_a, 1);
            add(at(link.a), a, at(link.a), a, springs, turning, 1);
            if (link.b < 0) continue;
            const Rows b = rows_of(link.arm_b, -1);
            add(at(link.b), b, at(link.b), b, springs, turning, 1);
            add(at(link.a), a, at(link.b), b, springs, turning, -1);
            add(at(link.b), b, at(link.a), a, springs, turning, -1);
        }
        // What nothing holds would make the matrix singular: a spring too weak to hold anything.
        for (std::size_t i = 0; i < n; ++i) k(i, i) += 1e-7 * stiffest;
        factorise();
    }
    /// L D L^T in place, D on the diagonal.
    void factorise() noexcept {
        const std::size_t n = unknowns();
        for (std::size_t j = 0; j < n; ++j) {
            for (std::size_t m = 0; m < j; ++m) k(j, j) -= square(k(j, m)) * k(m, m);
            for (std::size_t i = j + 1; i < n; ++i) {
                for (std::size_t m = 0; m < j; ++m) k(i, j) -= k(i, m) * k(j, m) * k(m, m);
                k(i, j) /= k(j, j);
            }
        }
    }

    void respond_to(const std::vector<Screw>& loads) {
        assemble();
        respond_again(loads);
    }
    void respond_again(const std::vector<Screw>& loads) {
        const std::size_t n = unknowns();
        q_.assign(n, 0);
        for (std::size_t m = 0; m < loads.size(); ++m)
            for (std::size_t a = 0; a < 3; ++a)
                q_[6 * m + a] = loads[m].along[static_cast<int>(a)],
                           q_[6 * m + 3 + a] = loads[m].about[static_cast<int>(a)];
        for (const StandingLink& link : links) {
            if (link.grip != StandingLink::Grip::slips) continue;
            push(link.a, link.arm_a, link.slip);
            if (link.b >= 0) push(link.b, link.arm_b, -link.slip);
        }
        for (std::size_t i = 0; i < n; ++i)
            for (std::size_t m = 0; m < i; ++m) q_[i] -= k(i, m) * q_[m];
        for (std::size_t i = n; i-- > 0;) {
            q_[i] /= k(i, i);
            for (std::size_t m = i + 1; m < n; ++m) q_[i] -= k(m, i) * q_[m];
        }
        for (StandingLink& link : links) {
            link.displacement =
                way_of(link.a, link.arm_a) - (link.b < 0 ? Vec3(Vec3::Zero()) : way_of(link.b, link.arm_b));
            link.rotation = turn_of(link.a) - (link.b < 0 ? Vec3(Vec3::Zero()) : turn_of(link.b));
        }
    }
    void push(Index member, const Vec3& arm, const Vec3& force) noexcept {
        const Vec3 torque = arm.cross(force) / size_;
        for (int a = 0; a < 3; ++a)
            q_[6 * at(member) + static_cast<std::size_t>(a)] += force[a],
                q_[6 * at(member) + 3 + static_cast<std::size_t>(a)] += torque[a];
    }
    Vec3 shift_of(Index member) const noexcept { return Vec3::Map(&q_[6 * at(member)]); }
    Vec3 turn_of(Index member) const noexcept { return Vec3::Map(&q_[6 * at(member) + 3]) / size_; }
    Vec3 way_of(Index member, const Vec3& arm) const noexcept {
        return shift_of(member) + turn_of(member).cross(arm);
    }

    /// Has broken bonds stick, slip or open, as their ways say. Returns whether any changed.
    bool regrip() noexcept {
        using Grip = StandingLink::Grip;
        bool changed = false;
        for (StandingLink& link : links) {
            if (link.sound) continue;
            const Real push = link.k.normal * link.compression(), most = friction_ * std::max(push, 0.0);
            const Vec3 stuck = -link.k.tangential * link.shear();
            const Grip before = link.grip;
            const Vec3 slip_before = link.slip;
            if (!(push > 0))
                link.grip = Grip::open, link.slip.setZero();
            else if (before == Grip::open)
                link.grip = Grip::sticks;
            else if (before == Grip::slips && link.slip.dot(stuck) <= 0)
                link.grip = Grip::sticks, link.slip.setZero();  // it would be dragged the way it goes
            else if (stuck.norm() > most)
                link.grip = Grip::slips, link.slip = most * stuck.normalized();
            else
                link.grip = Grip::sticks, link.slip.setZero();
            changed |= link.grip != before || (link.slip - slip_before).norm() > 1e-6 * most;
        }
        return changed;
    }
    Real furthest() const noexcept {
        Real most = 0;
        for (const Real displacement : q_) most = std::max(most, std::abs(displacement));
        return std::isfinite(most) ? most : std::numeric_limits<Real>::infinity();
    }

    Real size_, friction_;
    std::vector<Real> matrix_, q_;
    std::vector<std::array<Real, 4>> compliance_;
};

}  // namespace abrade
