#include "bullet_bridge/impact_time.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include <LinearMath/btMatrix3x3.h>
#include <LinearMath/btQuaternion.h>

#include "bullet_bridge/convex_pair.hpp"
#include "bullet_bridge/guarded.hpp"
#include "bullet_bridge/impact_shape.hpp"
#include "bullet_bridge/numbers.hpp"

extern "C" {
#include "base/deterministic.h"
}

namespace shiver
{
namespace
{

btQuaternion quaternion(const double q[4])
{
    return btQuaternion(q[1], q[2], q[3], q[0]);
}

// Where a body is at a time of the step, and how it moves.
struct Pose {
    btVector3 position, velocity, spin;
    btMatrix3x3 rotation;
};

btQuaternion turned(const ShvImpactMotion &motion, double time)
{
    const btVector3 spin = vector(motion.angular_velocity);
    const double rate = spin.length();
    if (!(rate * time > 0.0)) return quaternion(motion.orientation);
    const double half = 0.5 * rate * time;
    const btVector3 axis = spin * (shv_sin(half) / rate);
    return btQuaternion(axis.x(), axis.y(), axis.z(), shv_cos(half)) * quaternion(motion.orientation);
}

Pose pose_at(const ShvImpactMotion &motion, double time)
{
    Pose pose;
    const btVector3 acceleration = vector(motion.acceleration);
    pose.position = vector(motion.position) + time * vector(motion.velocity) + 0.5 * time * time * acceleration;
    pose.velocity = vector(motion.velocity) + time * acceleration;
    if (motion.turn == nullptr) {
        pose.spin = vector(motion.angular_velocity);
        pose.rotation = btMatrix3x3(turned(motion, time));
        return pose;
    }
    double orientation[4], spin[3];
    motion.turn(motion.data, time, orientation, spin);
    pose.spin = vector(spin);
    pose.rotation = btMatrix3x3(quaternion(orientation));
    return pose;
}

// Bounds of |ω|, and of the acceleration of a point 1 m from the body's position: |ω' × r + ω × (ω × r)| ≤ (|ω'| + ω²) r.
struct Turning {
    double rate, acceleration;
};

Turning turning(const ShvImpactBody &body)
{
    const ShvImpactMotion &motion = body.motion;
    if (body.shape->arm <= 0.0 && !body.shape->plane()) return {0.0, 0.0}; // a sphere about its centre
    if (motion.turn != nullptr) return {motion.fastest, motion.angular_acceleration + motion.fastest * motion.fastest};
    const double rate = vector(motion.angular_velocity).length();
    return {rate, rate * rate};
}

// Time from 0 to `end` before which a concave function that is positive at 0 surely stays so: its chords lie below it.
template <typename Concave> double safe_time(Concave value, double end)
{
    double left = 0.0, at_left = value(0.0), right = end, at_right = value(end);
    if (at_right >= 0.0) return end;
    for (int round = 0; round < 8 && right - left > 0.01 * left; round++) {
        const double chord = left + (right - left) * (at_left / (at_left - at_right));
        const double at_chord = value(chord);
        left = std::max(left, chord);
        at_left = at_chord;
        if (!(at_left > 0.0)) break; // a straight line's root, but for round-off
        const double middle = 0.5 * (left + right), at_middle = value(middle);
        if (at_middle > 0.0) {
            left = middle;
            at_left = at_middle;
        } else {
            right = middle;
            at_right = at_middle;
        }
    }
    return left;
}

// A point's height along some direction, and how fast it grows.
struct Track {
    double height, speed;
};

// A pair of pieces on its way.
class Approach
{
  public:
    Approach(const ShvImpactBody &first, const ShvImpactBody &second, const ShvImpactSettings &settings)
        : first_(first), second_(second), settings_(settings), turning_{turning(first), turning(second)}
    {
        const ShvImpactShape *shapes[2] = {first.shape, second.shape};
        for (int i = 0; i < 2; i++) {
            points_[i].resize(3 * static_cast<size_t>(shapes[i]->most_points));
            tracks_[i].reserve(static_cast<size_t>(std::max(first.shape->most_points, second.shape->most_points)));
        }
        acceleration_ = vector(second.motion.acceleration) - vector(first.motion.acceleration);
        start_[0] = pose_at(first.motion, 0.0);
        start_[1] = pose_at(second.motion, 0.0);
    }
    // Whether pieces surely stay apart until `limit`: a plane across their line of centres, or along their relative velocity
    // too, keeps parting them. Costs a fraction of a search.
    bool stay_apart(const ImpactPiece &first, const ImpactPiece &second, double limit);
    // Whether the pieces (the second null: a plane) impact before `limit`.
    bool search(const ImpactPiece &first, const ImpactPiece *second, double limit, ShvImpact &impact);
    int32_t evaluations = 0;

  private:
    // Contact is a gap of at most threshold + ¼ slop.
    struct Watch {
        double slop, allowed_penetration, threshold;
        double start;  // gap then
        bool touching; // since the start
        bool lowered;  // the threshold is below ½ slop
        int grazing;   // evaluations within the allowed depth, one after another
    };
    Watch start(const ImpactPiece &first, const ImpactPiece *second);
    bool judge(Watch &watch) const;
    void place(const ImpactPiece &piece, const ShvImpactShape &shape, const Pose &pose, int which, Core &core);
    Gap plane_gap() const;
    Gap measure(double time);
    bool part(const ImpactPiece &first, const ImpactPiece &second, const btVector3 &direction, double limit) const;
    double closing() const;
    double stride(double clearance, double left);
    double point_stride(double clearance, double left);
    double plane_stride(double clearance, double left);
    double arm_stride(double clearance, double left) const;
    double reach_stride(double left) const;
    void report(const Watch &watch, double time, ShvImpact &impact) const;

    const ShvImpactBody &first_, &second_;
    const ShvImpactSettings &settings_;
    const Turning turning_[2];
    btVector3 acceleration_; // of the second relative to the first
    const ImpactPiece *piece_[2] = {nullptr, nullptr};
    std::vector<double> points_[2]; // from the first body's position, world axes
    std::vector<Track> tracks_[2];  // of the points across the present normal
    ConvexPair pair_;
    Pose start_[2], pose_[2]; // at time 0, and now
    Gap gap_;                 // of now, from the first body's position
};

void Approach::place(const ImpactPiece &piece, const ShvImpactShape &shape, const Pose &pose, int which, Core &core)
{
    const btVector3 offset = pose.position - pose_[0].position;
    const double *from = shape.points.data() + 3 * static_cast<size_t>(piece.begin);
    double *to = points_[which].data();
    for (int32_t i = 0; i < 3 * piece.count; i += 3) store(pose.rotation * vector(from + i) + offset, to + i);
    core.points = to;
    core.count = piece.count;
    core.radius = shape.radius;
}

Gap Approach::plane_gap() const
{
    const ShvImpactShape &plane = *second_.shape;
    Gap gap;
    gap.normal = -(pose_[1].rotation * plane.normal);
    gap.first = support(pair_.first, gap.normal) + gap.normal * pair_.first.radius;
    gap.gap = gap.normal.dot(pose_[1].position - pose_[0].position - gap.first) - plane.offset;
    gap.second = gap.first + gap.normal * gap.gap;
    return gap;
}

Gap Approach::measure(double time)
{
    evaluations++;
    pose_[0] = time > 0.0 ? pose_at(first_.motion, time) : start_[0];
    pose_[1] = time > 0.0 ? pose_at(second_.motion, time) : start_[1];
    place(*piece_[0], *first_.shape, pose_[0], 0, pair_.first);
    if (piece_[1] == nullptr) return plane_gap();
    place(*piece_[1], *second_.shape, pose_[1], 1, pair_.second);
    btVector3 guess = gap_.normal;
    if (time == 0.0) guess = vector(points_[1].data()) - vector(points_[0].data());
    if (!(guess.length2() > 0.0)) guess.setValue(1.0, 0.0, 0.0);
    return convex_gap(pair_, guess);
}

double Approach::closing() const
{
    const btVector3 offset = pose_[1].position - pose_[0].position;
    const btVector3 first = pose_[0].velocity + pose_[0].spin.cross(gap_.first);
    const btVector3 second = pose_[1].velocity + pose_[1].spin.cross(gap_.second - offset);
    return gap_.normal.dot(first - second);
}

// Farthest reach of points that move on with their present speeds.
double reach(const std::vector<Track> &tracks, double time)
{
    double farthest[4] = {-HUGE_VAL, -HUGE_VAL, -HUGE_VAL, -HUGE_VAL}; // four, because one would wait for itself
    const size_t count = tracks.size();
    for (size_t i = 0; i < count; i++) {
        const double height = tracks[i].height + time * tracks[i].speed;
        if (height > farthest[i % 4]) farthest[i % 4] = height;
    }
    return std::max(std::max(farthest[0], farthest[1]), std::max(farthest[2], farthest[3]));
}

// Tracks along `direction` of the points of a body at `offset` that turns.
void follow(const Core &core, const btVector3 &offset, const btVector3 &spin, const btVector3 &direction,
            std::vector<Track> &tracks)
{
    const btVector3 lever = direction.cross(spin); // direction · (spin × r) = r · (direction × spin)
    tracks.resize(static_cast<size_t>(core.count));
    for (int32_t i = 0; i < core.count; i++) {
        const btVector3 point = vector(core.points + 3 * i);
        tracks[static_cast<size_t>(i)] = {direction.dot(point), lever.dot(point - offset)};
    }
}

// Across the present normal every point keeps its speed but for a bounded acceleration.
double Approach::point_stride(double clearance, double left)
{
    const btVector3 &normal = gap_.normal;
    const btVector3 offset = pose_[1].position - pose_[0].position;
    follow(pair_.first, btVector3(0, 0, 0), pose_[0].spin, normal, tracks_[0]);
    follow(pair_.second, offset, pose_[1].spin, -normal, tracks_[1]);
    const double start = clearance + reach(tracks_[0], 0.0) + reach(tracks_[1], 0.0);
    const double opening = normal.dot(pose_[1].velocity - pose_[0].velocity);
    const double bend = std::min(0.0, normal.dot(acceleration_)) - turning_[0].acceleration * piece_[0]->arm -
                        turning_[1].acceleration * piece_[1]->arm;
    return safe_time(
        [&](double time) {
            return start + time * opening + 0.5 * time * time * bend - reach(tracks_[0], time) -
                   reach(tracks_[1], time);
        },
        left);
}

// The same above a plane that may turn: seen from it a point at most `far` from its position, at speed at most V, has the
// further acceleration 2 ω V + (|ω'| + ω²) far.
double Approach::plane_stride(double clearance, double left)
{
    const btVector3 &normal = gap_.normal;
    const btVector3 offset = pose_[1].position - pose_[0].position, relative = pose_[1].velocity - pose_[0].velocity;
    const double speed = relative.length() + acceleration_.length() * left + turning_[0].rate * piece_[0]->arm;
    const double far = offset.length() + piece_[0]->arm + speed * left;
    follow(pair_.first, btVector3(0, 0, 0), pose_[0].spin, normal, tracks_[0]);
    follow(pair_.first, offset, pose_[1].spin, normal, tracks_[1]);
    for (size_t i = 0; i < tracks_[0].size(); i++) tracks_[0][i].speed -= tracks_[1][i].speed;
    const double start = clearance + reach(tracks_[0], 0.0);
    const double bend = (turning_[1].rate > 0.0 ? -acceleration_.length() : std::min(0.0, normal.dot(acceleration_))) -
                        turning_[0].acceleration * piece_[0]->arm - 2.0 * turning_[1].rate * speed -
                        turning_[1].acceleration * far;
    return safe_time(
        [&](double time) {
            return start + time * normal.dot(relative) + 0.5 * time * time * bend - reach(tracks_[0], time);
        },
        left);
}

// No point turns faster than rate × arm: better than accelerations over long strides.
double Approach::arm_stride(double clearance, double left) const
{
    const double opening = gap_.normal.dot(pose_[1].velocity - pose_[0].velocity) - turning_[0].rate * piece_[0]->arm -
                           turning_[1].rate * piece_[1]->arm;
    const double bend = std::min(0.0, gap_.normal.dot(acceleration_));
    return safe_time([=](double time) { return clearance + time * opening + 0.5 * time * time * bend; }, left);
}

// However they turn, the bodies' pieces stay in spheres about the bodies' positions.
double Approach::reach_stride(double left) const
{
    const btVector3 offset = pose_[1].position - pose_[0].position;
    const double distance = offset.length();
    const double clear = distance - piece_[0]->arm - piece_[1]->arm - first_.shape->radius - second_.shape->radius;
    if (!(clear > 0.0)) return 0.0;
    const btVector3 normal = offset / distance;
    const double opening = normal.dot(pose_[1].velocity - pose_[0].velocity);
    const double bend = std::min(0.0, normal.dot(acceleration_));
    return safe_time([=](double time) { return clear + time * opening + 0.5 * time * time * bend; }, left);
}

// How long the pieces surely stay farther apart than the threshold, `clearance` below the present gap.
double Approach::stride(double clearance, double left)
{
    if (piece_[1] == nullptr) return plane_stride(clearance, left);
    double best = arm_stride(clearance, left);
    if (turning_[0].rate + turning_[1].rate > 0.0 && best < left)
        best = std::max({best, point_stride(clearance, left), reach_stride(left)});
    return best;
}

void Approach::report(const Watch &watch, double time, ShvImpact &impact) const
{
    impact.closing = closing();
    // Under constant speed the depth gained since the start is speed × time, from rest under constant acceleration half that.
    const double gained = watch.start - gap_.gap;
    const bool at_once = watch.touching && time * impact.closing <= 4.0 * gained;
    impact.time = at_once ? 0.0 : time;
    impact.gap = gap_.gap;
    store(gap_.normal, impact.normal);
    store(gap_.first + pose_[0].position, impact.first);
    store(gap_.second + pose_[0].position, impact.second);
}

// Highest of a piece's points along a direction of its body's axes, radius included.
double highest(const ImpactPiece &piece, const ShvImpactShape &shape, const btVector3 &direction)
{
    const double *p = shape.points.data() + 3 * static_cast<size_t>(piece.begin);
    double most = -HUGE_VAL;
    for (int32_t i = 0; i < 3 * piece.count; i += 3)
        most = std::max(most, direction[0] * p[i] + direction[1] * p[i + 1] + direction[2] * p[i + 2]);
    return most + shape.radius;
}

// `direction`, of length 1, from the first to the second.
bool Approach::part(const ImpactPiece &first, const ImpactPiece &second, const btVector3 &direction, double limit) const
{
    const double slop = settings_.tolerance * std::max(first.size, second.size);
    const double clear = direction.dot(start_[1].position - start_[0].position) -
                         highest(first, *first_.shape, direction * start_[0].rotation) -
                         highest(second, *second_.shape, -direction * start_[1].rotation) - slop;
    if (!(clear > 0.0)) return false;
    const double opening = direction.dot(start_[1].velocity - start_[0].velocity);
    const double turned =
        std::min(2.0, turning_[0].rate * limit) * first.arm + std::min(2.0, turning_[1].rate * limit) * second.arm;
    const double bend = std::min(0.0, direction.dot(acceleration_));
    return clear - turned + std::min(0.0, limit * opening + 0.5 * limit * limit * bend) > 0.0;
}

bool Approach::stay_apart(const ImpactPiece &first, const ImpactPiece &second, double limit)
{
    const auto centre = [](const ImpactPiece &piece, const Pose &pose) {
        return pose.position + pose.rotation * (0.5 * (vector(piece.box.low) + vector(piece.box.high)));
    };
    const btVector3 apart = centre(second, start_[1]) - centre(first, start_[0]);
    const double distance = apart.length();
    if (!(distance > 0.0)) return false;
    if (part(first, second, apart / distance, limit)) return true;
    const btVector3 relative = start_[1].velocity - start_[0].velocity;
    if (!(relative.length2() > 0.0)) return false;
    const btVector3 aside = apart - relative * (apart.dot(relative) / relative.length2());
    const double miss = aside.length();
    return miss > 1e-6 * distance && part(first, second, aside / miss, limit);
}

// Of the smaller piece: distance at which gaps are found to full precision; of the larger one: what the tolerance is of at least; of
// the slop: how near its threshold a gap is at the time of impact.
const double close_of_small = 1e-7, least_of_large = 1e-3, found_of_slop = 0.25;
enum { MOST_EVALUATIONS = 4096, PATIENCE = 64 };

// The pieces at time 0, and what will count as contact.
Approach::Watch Approach::start(const ImpactPiece &first, const ImpactPiece *second)
{
    piece_[0] = &first;
    piece_[1] = second;
    pair_.large = second == nullptr ? first.size : std::max(first.size, second->size);
    pair_.small = second == nullptr ? first.size : std::min(first.size, second->size);
    pair_.close = close_of_small * pair_.small;
    gap_ = measure(0.0);
    Watch watch = {};
    watch.slop = settings_.tolerance * std::max(pair_.small, least_of_large * pair_.large);
    watch.allowed_penetration = watch.slop;
    watch.start = gap_.gap;
    watch.touching = watch.lowered = gap_.gap <= watch.slop;
    watch.threshold = watch.touching ? std::min(gap_.gap, 0.0) - 0.5 * watch.slop : 0.5 * watch.slop;
    return watch;
}

// Whether the present gap is an impact; if not, what will be one is adapted to it.
bool Approach::judge(Watch &watch) const
{
    if (watch.lowered && gap_.gap > 2.0 * watch.allowed_penetration) { // clear again
        watch.touching = watch.lowered = false;
        watch.threshold = 0.5 * watch.slop;
    }
    const double clearance = gap_.gap - watch.threshold;
    const bool contact = clearance <= found_of_slop * watch.slop;
    if (contact && closing() > settings_.slowest) return true;
    watch.grazing = clearance <= watch.allowed_penetration ? watch.grazing + 1 : 0;
    if (contact || watch.grazing == PATIENCE) {
        watch.allowed_penetration *= 2.0;
        watch.threshold = gap_.gap - watch.allowed_penetration;
        watch.lowered = true;
        watch.grazing = 0;
    }
    return false;
}

bool Approach::search(const ImpactPiece &first, const ImpactPiece *second, double limit, ShvImpact &impact)
{
    Watch watch = start(first, second);
    double time = 0.0;
    for (int round = 0; round < MOST_EVALUATIONS && !judge(watch); round++) {
        const double safe = stride(gap_.gap - watch.threshold, limit - time);
        if (!(time + safe < limit)) return false;
        time += safe;
        gap_ = measure(time);
    }
    report(watch, time, impact);
    return true;
}

// Extremes over [0, step] of v t + ½ a t² along each axis.
void sweep(Box &box, const btVector3 &velocity, const btVector3 &acceleration, double step)
{
    for (int i = 0; i < 3; i++) {
        const double v = velocity[i], a = acceleration[i];
        double low = std::min(0.0, v * step + 0.5 * a * step * step),
               high = std::max(0.0, v * step + 0.5 * a * step * step);
        if (v * a < 0.0 && -v / a < step) {
            low = std::min(low, -0.5 * v * v / a);
            high = std::max(high, -0.5 * v * v / a);
        }
        box.low[i] += low;
        box.high[i] += high;
    }
}

void grow(Box &box, double by)
{
    for (int i = 0; i < 3; i++) {
        box.low[i] -= by;
        box.high[i] += by;
    }
}

// Box of a turned and moved box.
Box carried(const Box &box, const btMatrix3x3 &rotation, const btVector3 &offset)
{
    const btVector3 low = vector(box.low), high = vector(box.high);
    const btVector3 middle = rotation * (0.5 * (low + high)) + offset,
                    half = rotation.absolute() * (0.5 * (high - low));
    Box moved;
    store(middle - half, moved.low);
    store(middle + half, moved.high);
    return moved;
}

// No point 1 m from the axis gets farther than this in a turn by `angle`: a chord.
double chord(double angle)
{
    return std::min(angle, 2.0);
}

double farthest(const Box &box)
{
    double square = 0.0;
    for (int i = 0; i < 3; i++) {
        const double side = std::max(std::fabs(box.low[i]), std::fabs(box.high[i]));
        square += side * side;
    }
    return std::sqrt(square);
}

// Box, in the axes of the second body, of all places of a piece of the first during the step as seen from there.
Box seen_from(const ShvImpactBody &first, const ImpactPiece &piece, const ShvImpactBody &second, double step)
{
    const Pose one = pose_at(first.motion, 0.0), other = pose_at(second.motion, 0.0);
    const btMatrix3x3 back = other.rotation.transpose();
    Box box = carried(piece.box, back * one.rotation, back * (one.position - other.position));
    sweep(box, back * (one.velocity - other.velocity),
          back * (vector(first.motion.acceleration) - vector(second.motion.acceleration)), step);
    grow(box, chord(turning(first).rate * step) * piece.arm);
    const double angle = turning(second).rate * step;
    if (angle > 0.0) grow(box, chord(angle) * farthest(box));
    return box;
}

// Pieces whose boxes meet a box, in order.
void find_pieces(const ShvImpactShape &shape, const Box &box, std::vector<int32_t> &found)
{
    struct Visit final : btDbvt::ICollide {
        std::vector<int32_t> *pieces;
        void Process(const btDbvtNode *leaf) override { pieces->push_back(leaf->dataAsInt); }
    } visit;
    visit.pieces = &found;
    found.clear();
    shape.tree.collideTV(shape.tree.m_root, btDbvtVolume::FromMM(vector(box.low), vector(box.high)), visit);
    std::sort(found.begin(), found.end());
}

void earliest(const ShvImpactBody &first, const ShvImpactBody &second, const ShvImpactSettings &settings, bool &found,
              ShvImpact &impact)
{
    Approach approach(first, second, settings);
    double limit = std::nextafter(settings.step, HUGE_VAL);
    std::vector<int32_t> candidates;
    const std::vector<ImpactPiece> &pieces = first.shape->pieces, &others = second.shape->pieces;
    const double slop = settings.tolerance * std::max(first.shape->size, second.shape->size);
    for (size_t i = 0; i < pieces.size(); i++) {
        candidates.assign(1, 0);
        if (!second.shape->plane()) {
            Box box = seen_from(first, pieces[i], second, settings.step);
            grow(box, slop);
            find_pieces(*second.shape, box, candidates);
        }
        for (const int32_t j : candidates) {
            const ImpactPiece *other = second.shape->plane() ? nullptr : &others[static_cast<size_t>(j)];
            if (!(limit > 0.0) || (other != nullptr && approach.stay_apart(pieces[i], *other, limit))) continue;
            if (!approach.search(pieces[i], other, limit, impact)) continue;
            found = true;
            limit = impact.time;
            impact.first_piece = static_cast<int32_t>(i);
            impact.second_piece = j;
        }
    }
    impact.evaluations = approach.evaluations;
}

// The body with more pieces, or the plane, is the one whose tree is asked.
void solve(const ShvImpactBody &first, const ShvImpactBody &second, const ShvImpactSettings &settings, bool &found,
           ShvImpact &impact)
{
    if (first.shape->plane() && second.shape->plane()) return;
    const bool swap =
        first.shape->plane() || (!second.shape->plane() && first.shape->pieces.size() > second.shape->pieces.size());
    if (!swap) {
        earliest(first, second, settings, found, impact);
        return;
    }
    earliest(second, first, settings, found, impact);
    std::swap(impact.first_piece, impact.second_piece);
    for (int i = 0; i < 3; i++) {
        impact.normal[i] = -impact.normal[i];
        std::swap(impact.first[i], impact.second[i]);
    }
}

bool usable(const ShvImpactMotion &motion)
{
    const double *q = motion.orientation;
    const double square = q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3];
    const bool bounded =
        motion.turn == nullptr || (std::isfinite(motion.fastest) && motion.fastest >= 0.0 &&
                                   std::isfinite(motion.angular_acceleration) && motion.angular_acceleration >= 0.0);
    return bounded && finite(motion.position, 3) && finite(motion.velocity, 3) && finite(motion.acceleration, 3) &&
           finite(motion.angular_velocity, 3) && std::fabs(square - 1.0) < 1e-6;
}

bool usable(const ShvImpactSettings &settings)
{
    return std::isfinite(settings.step) && settings.step >= 0.0 && settings.tolerance >= 1e-9 &&
           settings.tolerance <= 0.01 && settings.slowest >= 0.0;
}

} // namespace
} // namespace shiver

ShvStatus shv_impact_time(const ShvImpactBody *first, const ShvImpactBody *second, const ShvImpactSettings *settings,
                          bool *found, ShvImpact *impact, ShvError *error)
{
    *found = false;
    *impact = ShvImpact();
    if (!shiver::usable(*settings))
        return shv_fail(
            error, SHV_BAD_INPUT,
            "the time of impact needs a finite step ≥ 0, a tolerance of 1e-9 … 0.01 and a speed ≥ 0, not %g, "
            "%g and %g",
            settings->step, settings->tolerance, settings->slowest);
    if (!shiver::usable(first->motion) || !shiver::usable(second->motion))
        return shv_fail(error, SHV_BAD_INPUT,
                        "the time of impact needs finite motion and orientations of length 1: a body "
                        "has left its bounds");
    return shiver::guarded(error, [&] {
        shiver::solve(*first, *second, *settings, *found, *impact);
        return SHV_OK;
    });
}
