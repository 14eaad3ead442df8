// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// How to pick what was found: for every fruit a direction of approach and a pre-grasp pose that are clear of the other
/// fruit and of the spaces to keep out of, whether an arm can follow it, and the order to pick in.
///
/// The gripper on its way is a capsule about the line from the pre-grasp position to the fruit's centre. A space to
/// keep out of that contains the fruit's centre does not count for that fruit (a cylinder about the truss is meant for
/// looking, not for picking). Whether the arm can reach is a callable, so that any arm's own motion planner can answer;
/// plan/arm_approach.hpp answers for our UR3 model.
///
/// Fruit are planned in rounds: first those whose approach is free with all the others there, then those that are free
/// once these are picked, and so on. Within a round the nearer ones come first, those as near as `depth_tie` in the
/// order of the arm's shortest moves. The same fruit in another order give the same plan. World frame, metres. Cost: a
/// few ms for nine fruit with the UR3; the most for fruit that no direction reaches.
#pragma once

#include <agrisee/arm/limits.hpp>
#include <agrisee/geometry/direction_bins.hpp>
#include <agrisee/plan/approach.hpp>
#include <agrisee/plan/directions.hpp>

#include <algorithm>
#include <bitset>
#include <numeric>
#include <tuple>

namespace agrisee::plan {

/// The directions from a fruit's centre in which its surface was observed.
using SeenDirections = std::bitset<DirectionBins::kCount>;

/// What surrounds the fruit.
struct PickingScene {
  std::vector<KeepOut> keep_out;                  ///< world
  Eigen::Vector3d eye = Eigen::Vector3d::Zero();  ///< where the robot stands: the front is what faces it
  Joints joints = Joints::Zero();                 ///< of the arm before the first pick (rad)
  std::vector<SeenDirections> seen = {};          ///< of each fruit, or empty where it is not known
};

/// The directions in which each fruit's surface was observed: those of its points from its centre; none without a body.
template <typename S>
std::vector<SeenDirections> seen_directions(const PointCloud<S>& cloud, const Labels& labels,
                                            const std::vector<Fruit>& fruits) {
  std::vector<SeenDirections> seen(fruits.size());
  std::vector<std::ptrdiff_t> fruit_of;
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
    const Eigen::Vector3d d =
        cloud.points[i].template cast<double>() - fruits[static_cast<std::size_t>(f)].body->center;
    if (is_finite(d) && d.squaredNorm() > 0.0)
      seen[static_cast<std::size_t>(f)].set(static_cast<std::size_t>(DirectionBins::bin(d)));
  }
  return seen;
}

/// The space that a fruit takes up: its body, or a sphere with the spread of its points about their mean.
inline OrientedEllipsoid occupied(const Fruit& fruit) {
  if (fruit.body) return {fruit.body->center, fruit.body->radii, fruit.body->axes};
  return {fruit.centroid, Eigen::Vector3d::Constant(std::max(fruit.sigma.norm(), 1e-3)), Eigen::Matrix3d::Identity()};
}

namespace detail {

/// A fruit while it is being planned.
struct PickingCandidate {
  std::size_t fruit = 0;  // index in the caller's list
  int id = 0;
  OrientedEllipsoid body;
  bool has_body = false;
  double depth = 0.0;  // from the robot
  std::vector<KeepOut> keep_out;
  std::vector<Eigen::Vector3d> directions;  // best first
  std::vector<PickingReason> verdicts;      // of each direction; not_tested = not final
};

/// Directions of approach to fruit `f`, best first.
inline std::vector<Eigen::Vector3d> ranked_directions(const std::vector<PickingCandidate>& all, std::size_t f,
                                                      const Eigen::Vector3d& growth_axis, const SeenDirections* seen,
                                                      const Eigen::Vector3d& eye, const PickingParameters& p) {
  const OrientedEllipsoid& body = all[f].body;
  Eigen::Vector3d front = body.center - eye;
  front.z() = 0.0;
  front = front.norm() > 1e-9 ? Eigen::Vector3d(front.normalized()) : Eigen::Vector3d(Eigen::Vector3d::UnitY());
  struct Neighbour {
    Eigen::Vector3d towards;
    double weight;
  };
  std::vector<Neighbour> neighbours;
  const double r = body.radii.mean();
  for (std::size_t j = 0; j < all.size(); ++j) {
    const Eigen::Vector3d d = all[j].body.center - body.center;
    const double away = d.norm(), gap = std::max(away - r - all[j].body.radii.mean(), 0.0);
    if (j != f && away > 1e-9) neighbours.push_back({d / away, std::exp(-gap / r)});
  }
  const auto& bins = DirectionBins::directions();
  std::vector<std::pair<double, std::size_t>> scores;
  const std::vector<Eigen::Vector3d> spread = spread_directions(p.directions);
  const double cos_pedicel = std::cos(p.pedicel_angle), cos_cap = std::cos(deg(45));
  for (std::size_t i = 0; i < spread.size(); ++i) {
    const Eigen::Vector3d &d = spread[i], side = -d;
    if (p.pedicel_angle > 0.0 && side.dot(growth_axis) > cos_pedicel) continue;
    double score = p.front_weight * d.dot(front) - p.across_weight * std::pow(d.dot(growth_axis), 2);
    for (const Neighbour& n : neighbours)
      score -= p.away_weight * n.weight * std::pow(std::max(side.dot(n.towards), 0.0), 2);
    if (seen) {
      double cap = 0.0, covered = 0.0;
      for (std::size_t b = 0; b < bins.size(); ++b) {
        if (bins[b].dot(side) < cos_cap) continue;
        cap += DirectionBins::shares()[b];
        if ((*seen)[b]) covered += DirectionBins::shares()[b];
      }
      score += p.seen_weight * covered / cap;
    }
    scores.emplace_back(-score, i);
  }
  std::sort(scores.begin(), scores.end());
  std::vector<Eigen::Vector3d> out;
  for (const auto& s : scores) out.push_back(spread[s.second]);
  return out;
}

/// The wish to approach a fruit along `direction`.
inline ApproachRequest request_of(const PickingCandidate& c, const Eigen::Vector3d& direction,
                                  const std::vector<OrientedEllipsoid>& others, const PickingParameters& p) {
  const Eigen::Vector3d& center = c.body.center;
  const double surface = 1.0 / (c.body.axes.transpose() * direction).cwiseQuotient(c.body.radii).norm();
  return {direction, center - (surface + p.stand_off) * direction, center - (surface + p.contact) * direction,
          c.keep_out, others};
}

/// What comes of approaching a fruit along `direction` while `others` hang there.
inline ApproachAnswer try_direction(const PickingCandidate& c, const Eigen::Vector3d& direction,
                                    const std::vector<OrientedEllipsoid>& others, const Joints& current,
                                    const ReachApproach& reach, const PickingParameters& p) {
  const Capsule gripper = swept_gripper(c.body, direction, p);
  for (const KeepOut& space : c.keep_out)
    if (overlap(gripper, space)) return {std::nullopt, PickingReason::blocked_by_keep_out};
  for (const OrientedEllipsoid& other : others)
    if (meets(gripper, other)) return {std::nullopt, PickingReason::blocked_by_fruit};
  const ApproachRequest request = request_of(c, direction, others, p);
  if (reach) return reach(request, current);
  return {ReachableApproach{look_along(request.start, direction), std::nullopt}, PickingReason::not_tested};
}

/// The best approach while `others` hang there; sets what the picking says of it. False when there is none.
inline bool plan_approach(PickingCandidate& c, const std::vector<OrientedEllipsoid>& others, const Joints& current,
                          const ReachApproach& reach, const PickingParameters& p, Picking& out) {
  std::size_t farthest = 0;
  out.reason = PickingReason::no_body;
  for (std::size_t i = 0; i < c.directions.size(); ++i) {
    PickingReason reason = c.verdicts[i];
    if (reason == PickingReason::not_tested) {
      throw_if_cancelled();
      const ApproachAnswer answer = try_direction(c, c.directions[i], others, current, reach, p);
      if (answer.reached) {
        out.direction = c.directions[i];
        out.world_T_pre_grasp = answer.reached->world_T_pre_grasp;
        out.joints = answer.reached->joints;
        out.reachable = static_cast<bool>(reach);
        out.reason = reach ? PickingReason::reachable : PickingReason::not_tested;
        return true;
      }
      reason = std::max(answer.reason, PickingReason::blocked_by_keep_out);
      if (reason != PickingReason::blocked_by_fruit && reason != PickingReason::arm_meets_fruit) c.verdicts[i] = reason;
    }
    if (reason > out.reason) {
      out.reason = reason;
      farthest = i;
    }
  }
  if (c.directions.empty()) return false;
  const ApproachRequest request = request_of(c, c.directions[farthest], others, p);
  out.direction = request.direction;
  out.world_T_pre_grasp = look_along(request.start, request.direction);
  return false;
}

}  // namespace detail

/// Plan the picking of all fruit: an entry each, in their order.
/// @param fruits as located
/// @param scene what surrounds them
/// @param reach answers for the arm; empty: directions and order without it, `not_tested`
/// @param parameters see their struct
/// @throws InputError for a fruit, an eye or joints that are not finite, or when `scene.seen` is neither empty nor one
/// per
///   fruit; ParameterError
inline std::vector<Picking> plan_picking(const std::vector<Fruit>& fruits, const PickingScene& scene,
                                         const ReachApproach& reach = {}, const PickingParameters& parameters = {}) {
  parameters.check();
  for (const KeepOut& space : scene.keep_out) space.check();
  check_input(scene.eye.allFinite() && scene.joints.allFinite(), "plan_picking: the eye or the joints are not finite");
  check_input(scene.seen.empty() || scene.seen.size() == fruits.size(), "plan_picking: `seen` does not fit the fruit");
  std::vector<detail::PickingCandidate> all(fruits.size());
  for (std::size_t i = 0; i < fruits.size(); ++i) {
    detail::PickingCandidate& c = all[i];
    c.fruit = i;
    c.id = fruits[i].id;
    c.body = occupied(fruits[i]);
    c.has_body = fruits[i].body.has_value();
    check_input(c.body.center.allFinite() && c.body.radii.allFinite() && c.body.axes.allFinite() &&
                    c.body.radii.minCoeff() > 0.0 && fruits[i].orientation.allFinite(),
                "plan_picking: a fruit is not finite or has no size");
    for (const KeepOut& space : scene.keep_out)
      if (distance(space, c.body.center) > 0.0) c.keep_out.push_back(space);
  }
  // An order of its own, so that the caller's plays no part.
  std::sort(all.begin(), all.end(), [](const detail::PickingCandidate& a, const detail::PickingCandidate& b) {
    const Eigen::Vector3d &p = a.body.center, &q = b.body.center;
    return std::tuple(p.x(), p.y(), p.z(), a.id) < std::tuple(q.x(), q.y(), q.z(), b.id);
  });
  Eigen::Vector3d front = Eigen::Vector3d::Zero();
  for (const auto& c : all) front += c.body.center - scene.eye;
  front.z() = 0.0;
  if (front.norm() > 1e-9) front.normalize();
  for (std::size_t i = 0; i < all.size(); ++i) {
    auto& c = all[i];
    c.depth = front.dot(c.body.center - scene.eye);
    if (!c.has_body) continue;
    c.directions =
        detail::ranked_directions(all, i, fruits[c.fruit].orientation.col(2),
                                  scene.seen.empty() ? nullptr : &scene.seen[c.fruit], scene.eye, parameters);
    c.verdicts.assign(c.directions.size(), PickingReason::not_tested);
  }

  std::vector<Picking> plan(fruits.size());
  std::vector<std::size_t> hanging(all.size());  // indices in `all`, those that are still there
  std::iota(hanging.begin(), hanging.end(), std::size_t{0});
  std::vector<std::size_t> picked;
  const auto others_than = [&](std::size_t f) {
    std::vector<OrientedEllipsoid> others;
    for (std::size_t j : hanging)
      if (j != f) others.push_back(all[j].body);
    return others;
  };
  int order = 0;
  Joints at = scene.joints;
  for (bool first = true;; first = false) {
    std::vector<std::size_t> free;
    for (std::size_t f : hanging) {
      Picking& out = plan[all[f].fruit];
      // After the first round only what fruit stood in the way of can have changed.
      if (!first && out.reason != PickingReason::blocked_by_fruit && out.reason != PickingReason::arm_meets_fruit &&
          std::none_of(all[f].verdicts.begin(), all[f].verdicts.end(),
                       [](PickingReason r) { return r == PickingReason::not_tested; }))
        continue;
      std::vector<OrientedEllipsoid> others = others_than(f);
      if (!detail::plan_approach(all[f], others, scene.joints, reach, parameters, out)) continue;
      free.push_back(f);
      for (std::size_t j : picked) {
        others.push_back(all[j].body);
        const ApproachAnswer with =
            detail::try_direction(all[f], out.direction, others, scene.joints, reach, parameters);
        if (!with.reached || with.reached->joints != out.joints) out.after.push_back(all[j].id);
        others.pop_back();
      }
      std::sort(out.after.begin(), out.after.end());
    }
    if (free.empty()) break;
    hanging.erase(std::remove_if(hanging.begin(), hanging.end(),
                                 [&](std::size_t f) { return std::find(free.begin(), free.end(), f) != free.end(); }),
                  hanging.end());
    while (!free.empty()) {  // front to back; ties by the shortest move from the one before, then by id
      double nearest = all[free[0]].depth;
      for (std::size_t f : free) nearest = std::min(nearest, all[f].depth);
      const auto rank = [&](std::size_t f) {
        const auto& joints = plan[all[f].fruit].joints;
        const bool tied = all[f].depth <= nearest + parameters.depth_tie;
        return std::tuple(tied ? 0 : 1, joints ? arm::joint_distance(at, *joints) : 0.0, all[f].id);
      };
      const auto next =
          std::min_element(free.begin(), free.end(), [&](std::size_t a, std::size_t b) { return rank(a) < rank(b); });
      Picking& out = plan[all[*next].fruit];
      out.order = ++order;
      if (out.joints) at = *out.joints;
      picked.push_back(*next);
      free.erase(next);
    }
  }
  std::sort(hanging.begin(), hanging.end(), [&](std::size_t a, std::size_t b) {
    return std::tuple(all[a].depth, all[a].id) < std::tuple(all[b].depth, all[b].id);
  });
  for (std::size_t f : hanging) plan[all[f].fruit].order = ++order;
  return plan;
}

}  // namespace agrisee::plan
