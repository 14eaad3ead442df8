// SPDX-License-Identifier: BSD-3-Clause
#include <agrisee/arm/limits.hpp>
#include <agrisee/core/cancellation.hpp>
#include <agrisee/pick/picking.hpp>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <set>
#include <tuple>

#include "pick/ranked_directions.hpp"

namespace agrisee::pick {

namespace {

/// What became of a direction when it was tested last.
struct LastAnswer {
  PickingReason reason = PickingReason::not_tested;
  std::optional<std::size_t> picked;  // number of fruit that had been picked before; empty before the first test

  /// Whether a further test may answer something else: only the other fruit can have changed, by being picked.
  bool may_change() const {
    return reason == PickingReason::not_tested || reason == PickingReason::blocked_by_fruit ||
           reason == PickingReason::arm_meets_fruit;
  }
  /// Whether the direction has to be tested when so many fruit have been picked.
  bool is_open(std::size_t now) const { return may_change() && picked != now; }
};

/// A fruit while its picking is being planned.
struct Candidate {
  std::size_t index = 0;  // in the caller's list
  int id = 0;
  OrientedEllipsoid body;
  bool has_body = false;
  double depth = 0.0;                       // distance from the robot along the front (m)
  std::vector<KeepOut> keep_out;            // that apply to this fruit
  std::vector<RankedDirection> directions;  // of approach, best first
  std::vector<LastAnswer> answers;          // one per direction
};

/// @throws InputError when fruit or scene cannot be planned with, see plan_picking; ParameterError
void check_scene(const std::vector<Fruit>& fruits, const PickingScene& scene) {
  for (const KeepOut& space : scene.keep_out) space.check();
  check_input(scene.robot.allFinite() && scene.joints.allFinite(),
              "plan_picking: the robot's position or the joints are not finite");
  check_input(scene.seen.empty() || scene.seen.size() == fruits.size(), "plan_picking: `seen` does not fit the fruit");
  std::set<int> ids;
  for (const Fruit& fruit : fruits)
    if (!ids.insert(fruit.id).second)
      throw InputError("plan_picking: two fruits have the id " + std::to_string(fruit.id));
}

/// The fruit in an order that does not depend on the caller's, and the keep-out spaces that apply to each.
std::vector<Candidate> sorted_candidates(const std::vector<Fruit>& fruits, const std::vector<KeepOut>& keep_out) {
  std::vector<Candidate> all(fruits.size());
  for (std::size_t i = 0; i < fruits.size(); ++i) {
    Candidate& c = all[i];
    c.index = i;
    c.id = fruits[i].id;
    c.body = occupied(fruits[i]);
    c.has_body = fruits[i].body.has_value();
    check_input(c.body.center.allFinite() && c.body.radii.allFinite() && c.body.axes.allFinite() &&
                    c.body.radii.minCoeff() > 0.0 && fruits[i].orientation.allFinite(),
                "plan_picking: a fruit is not finite or has no size");
    for (const KeepOut& space : keep_out)
      if (distance(space, c.body.center) > 0.0) c.keep_out.push_back(space);
  }
  std::sort(all.begin(), all.end(), [](const Candidate& a, const Candidate& b) {
    const Eigen::Vector3d &p = a.body.center, &q = b.body.center;
    return std::tuple(p.x(), p.y(), p.z(), a.id) < std::tuple(q.x(), q.y(), q.z(), b.id);
  });
  return all;
}

/// Depth (m) of each fruit: its distance from the robot along the horizontal direction from the robot to the mean of
/// all fruit.
void set_depths(std::vector<Candidate>& all, const Eigen::Vector3d& robot) {
  Eigen::Vector3d front = Eigen::Vector3d::Zero();
  for (const Candidate& c : all) front += c.body.center - robot;
  front.z() = 0.0;
  if (front.norm() > 1e-9) front.normalize();
  for (Candidate& c : all) c.depth = front.dot(c.body.center - robot);
}

/// The pieces of the surroundings that are at least kRim from every fruit.
std::vector<SurfacePiece> pieces_off(const std::vector<Candidate>& all, const Cloud& surroundings) {
  std::vector<SurfacePiece> pieces = surface_pieces(surroundings);
  for (const Candidate& c : all) pieces = pieces_beyond(kRim, c.body, pieces);
  return pieces;
}

/// The request to approach a fruit along `direction`.
ApproachRequest request_of(const Candidate& c, const Eigen::Vector3d& direction,
                           const std::vector<OrientedEllipsoid>& others, const PickingParameters& parameters) {
  const Eigen::Vector3d& center = c.body.center;
  const double surface = surface_distance(c.body, direction);
  return {direction, center - (surface + parameters.stand_off) * direction,
          center - (surface + parameters.contact) * direction, c.keep_out, others};
}

/// The picking of all fruit in rounds.
class PickingRounds {
 public:
  PickingRounds(std::vector<Candidate> all, const Joints& joints, const ReachApproach& reach,
                const PickingParameters& parameters)
      : all_(std::move(all)), joints_(joints), at_(joints), reach_(reach), parameters_(parameters), plan_(all_.size()) {
    hanging_.resize(all_.size());
    std::iota(hanging_.begin(), hanging_.end(), std::size_t{0});
  }

  /// Run all rounds. An entry per fruit, in the caller's order.
  std::vector<Picking> plan() {
    // What could only be picked through its surroundings may be free when others have been picked: a round allows more
    // only if there is nothing to pick with less.
    constexpr double kLittle = 0.1, kMore = 4.0, kMost = 2.0;  // kLittle and kMost: of the gripper's cross-section
    const double section = kPi * std::pow(parameters_.gripper_radius, 2);
    double allowed = kLittle * section;
    for (bool first = true;; first = false) {
      const bool all =
          !(parameters_.clear_weight > 0.0) || !(allowed < kMost * section) || allowed >= parameters_.max_crossed;
      std::vector<std::size_t> free = plan_round(all ? parameters_.max_crossed : allowed, first);
      if (free.empty() && all) break;
      allowed = free.empty() ? kMore * allowed : kLittle * section;
      if (free.empty()) continue;
      hanging_.erase(
          std::remove_if(hanging_.begin(), hanging_.end(),
                         [&](std::size_t f) { return std::find(free.begin(), free.end(), f) != free.end(); }),
          hanging_.end());
      pick_in_order(std::move(free));
    }
    // Fruit that cannot be picked come last, front to back.
    std::sort(hanging_.begin(), hanging_.end(), [&](std::size_t a, std::size_t b) {
      return std::tuple(all_[a].depth, all_[a].id) < std::tuple(all_[b].depth, all_[b].id);
    });
    for (std::size_t f : hanging_) plan_[all_[f].index].order = ++order_;
    return std::move(plan_);
  }

 private:
  /// Plan the approach to each hanging fruit; returns those (indices in `all_`) whose approach is free.
  /// @param allowed how much of the surroundings it may cross in this round (m2)
  std::vector<std::size_t> plan_round(double allowed, bool first) {
    std::vector<std::size_t> free;
    for (std::size_t f : hanging_) {
      Picking& out = plan_[all_[f].index];
      if (!first && !may_have_changed(all_[f])) continue;
      std::vector<OrientedEllipsoid> others = others_than(f);
      if (!plan_approach(all_[f], others, allowed, out)) continue;
      free.push_back(f);
      out.after = blocking(f, out, others);
    }
    return free;
  }

  /// Whether a fruit that could not be picked may be free now.
  static bool may_have_changed(const Candidate& c) {
    return std::any_of(c.answers.begin(), c.answers.end(), [](const LastAnswer& a) { return a.may_change(); });
  }

  /// The hanging fruit but `f`.
  std::vector<OrientedEllipsoid> others_than(std::size_t f) const {
    std::vector<OrientedEllipsoid> others;
    for (std::size_t j : hanging_)
      if (j != f) others.push_back(all_[j].body);
    return others;
  }

  /// Ids (ascending) of the picked fruit that would have been in the way of the approach to fruit `f`.
  std::vector<int> blocking(std::size_t f, const Picking& out, std::vector<OrientedEllipsoid>& others) const {
    std::vector<int> after;
    for (std::size_t j : picked_) {
      others.push_back(all_[j].body);
      const ApproachAnswer with = try_direction(all_[f], {out.direction, out.crossed}, others);
      if (!with.reached || with.reached->joints != out.joints) after.push_back(all_[j].id);
      others.pop_back();
    }
    std::sort(after.begin(), after.end());
    return after;
  }

  /// Whether a fruit can be approached along a direction while `others` are hanging.
  ApproachAnswer try_direction(const Candidate& c, const RankedDirection& along,
                               const std::vector<OrientedEllipsoid>& others) const {
    const Capsule gripper = swept_gripper(c.body, along.direction, parameters_);
    const Capsule outside = short_of_center(gripper);
    for (const KeepOut& space : c.keep_out)
      if (overlap(outside, space)) return {std::nullopt, PickingReason::blocked_by_keep_out};
    if (along.crossed > parameters_.max_crossed && parameters_.max_crossed < PickingParameters::kNoLimit)
      return {std::nullopt, PickingReason::blocked_by_surroundings};
    for (const OrientedEllipsoid& other : others)
      if (meets(gripper, other)) return {std::nullopt, PickingReason::blocked_by_fruit};
    const ApproachRequest request = request_of(c, along.direction, others, parameters_);
    if (reach_) return reach_(request, joints_);
    return {ReachableApproach{look_along(request.start, along.direction), std::nullopt}, PickingReason::not_tested};
  }

  /// Write the best approach while `others` are hanging to `out`; false, with the reason, when there is none. Answers
  /// are kept for later rounds; those that depend on other fruit until one of them is picked.
  /// @param allowed directions that cross more (m2), but not too much, are left for later rounds
  bool plan_approach(Candidate& c, const std::vector<OrientedEllipsoid>& others, double allowed, Picking& out) const {
    std::size_t farthest = 0;
    out.reason = PickingReason::no_body;
    for (std::size_t i = 0; i < c.directions.size(); ++i) {
      const RankedDirection& d = c.directions[i];
      PickingReason reason = c.answers[i].reason;
      if (c.answers[i].is_open(picked_.size())) {
        if (d.crossed > allowed && d.crossed <= parameters_.max_crossed) continue;
        throw_if_cancelled();
        const ApproachAnswer answer = try_direction(c, d, others);
        if (answer.reached) {
          out.direction = d.direction;
          out.crossed = d.crossed;
          out.world_T_pre_grasp = answer.reached->world_T_pre_grasp;
          out.joints = answer.reached->joints;
          out.reachable = static_cast<bool>(reach_);
          out.reason = reach_ ? PickingReason::reachable : PickingReason::not_tested;
          return true;
        }
        reason = std::max(answer.reason, PickingReason::blocked_by_keep_out);
        c.answers[i] = {reason, picked_.size()};
      }
      if (reason > out.reason) {
        out.reason = reason;
        farthest = i;
      }
    }
    if (c.directions.empty()) return false;
    const ApproachRequest request = request_of(c, c.directions[farthest].direction, others, parameters_);
    out.direction = request.direction;
    out.crossed = c.directions[farthest].crossed;
    out.world_T_pre_grasp = look_along(request.start, request.direction);
    return false;
  }

  /// Number the fruit of a round: front to back; fruit of about the same depth by the arm's shortest move from the
  /// pick before, then by id.
  void pick_in_order(std::vector<std::size_t> free) {
    while (!free.empty()) {
      double nearest = all_[free[0]].depth;
      for (std::size_t f : free) nearest = std::min(nearest, all_[f].depth);
      const auto rank = [&](std::size_t f) {
        const auto& joints = plan_[all_[f].index].joints;
        const bool tied = all_[f].depth <= nearest + parameters_.depth_tie;
        return std::tuple(tied ? 0 : 1, joints ? arm::joint_distance(at_, *joints) : 0.0, all_[f].id);
      };
      const auto next =
          std::min_element(free.begin(), free.end(), [&](std::size_t a, std::size_t b) { return rank(a) < rank(b); });
      Picking& out = plan_[all_[*next].index];
      out.order = ++order_;
      if (out.joints) at_ = *out.joints;
      picked_.push_back(*next);
      free.erase(next);
    }
  }

  std::vector<Candidate> all_;
  Joints joints_;  // before the first pick (rad); every approach starts from there
  Joints at_;      // at the last pick (rad)
  const ReachApproach& reach_;
  const PickingParameters& parameters_;
  std::vector<Picking> plan_;         // in the caller's order
  std::vector<std::size_t> hanging_;  // indices in `all_` of the fruit that have not been picked
  std::vector<std::size_t> picked_;   // and of those that have been
  int order_ = 0;
};

}  // namespace

std::vector<SeenDirections> seen_directions(const Cloud& cloud, const Labels& labels,
                                            const std::vector<Fruit>& fruits) {
  std::vector<SeenDirections> seen(fruits.size());
  std::vector<std::ptrdiff_t> fruit_of;  // by label; -1 = none
  for (std::size_t f = 0; f < fruits.size(); ++f) {
    if (!fruits[f].body || fruits[f].id < 1) continue;
    const auto id = static_cast<std::size_t>(fruits[f].id);
    if (fruit_of.size() <= id) fruit_of.resize(id + 1, -1);
    fruit_of[id] = static_cast<std::ptrdiff_t>(f);
  }
  for (std::size_t i = 0; i < labels.size() && i < cloud.size(); ++i) {
    if (labels[i] < 1 || static_cast<std::size_t>(labels[i]) >= fruit_of.size()) continue;
    const std::ptrdiff_t f = fruit_of[static_cast<std::size_t>(labels[i])];
    if (f < 0) continue;
    const Eigen::Vector3d d = cloud.points[i].cast<double>() - fruits[static_cast<std::size_t>(f)].body->center;
    if (is_finite(d) && d.squaredNorm() > 0.0)
      seen[static_cast<std::size_t>(f)].set(static_cast<std::size_t>(DirectionBins::bin(d)));
  }
  return seen;
}

OrientedEllipsoid occupied(const Fruit& fruit) {
  if (fruit.body) return {fruit.body->center, fruit.body->radii, fruit.body->axes};
  return {fruit.centroid, Eigen::Vector3d::Constant(std::max(fruit.sigma.norm(), 1e-3)), Eigen::Matrix3d::Identity()};
}

std::vector<Picking> plan_picking(const std::vector<Fruit>& fruits, const PickingScene& scene,
                                  const ReachApproach& reach, const PickingParameters& parameters) {
  parameters.check();
  check_scene(fruits, scene);
  std::vector<Candidate> all = sorted_candidates(fruits, scene.keep_out);
  set_depths(all, scene.robot);
  const std::vector<SurfacePiece> pieces = pieces_off(all, scene.surroundings);
  for (std::size_t i = 0; i < all.size(); ++i) {
    Candidate& c = all[i];
    if (!c.has_body) continue;
    const SeenDirections* seen = scene.seen.empty() ? nullptr : &scene.seen[c.index];
    std::vector<OrientedEllipsoid> others;
    for (const Candidate& other : all)
      if (&other != &c) others.push_back(other.body);
    c.directions =
        ranked_directions(c.body, others, {fruits[c.index].orientation.col(2), seen, pieces}, scene.robot, parameters);
    c.answers.resize(c.directions.size());
  }
  return PickingRounds(std::move(all), scene.joints, reach, parameters).plan();
}

}  // namespace agrisee::pick
