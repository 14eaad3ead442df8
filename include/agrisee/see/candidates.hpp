// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// The frontiers that wait for a view, each with the view that is proposed for it (SEE++): which of these views are
/// nearest to a position, and which frontiers they see. World frame, metres.
#pragma once

#include <agrisee/core/parallel.hpp>
#include <agrisee/see/occluders.hpp>
#include <agrisee/see/occlusion.hpp>

#include <algorithm>
#include <functional>
#include <map>
#include <utility>
#include <vector>

namespace agrisee::see {

/// A frontier and its view.
struct Candidate {
  Frontier frame;       ///< as of when the point became a frontier, or of when it was renewed
  ViewProposal view;    ///< proposed for it
  Index node = -1;      ///< in the visibility graph
  int step = -1;        ///< the last step in which the arcs out of its node were updated
  int frame_step = -1;  ///< the step in which the frame was estimated
  bool moved = false;   ///< whether the view controller has moved the view
  double depth = 0.0;   ///< surface_depth() at the frontier (m)
  int depth_step = -1;  ///< the step that `depth` belongs to
};

/// Candidates by the index of their points.
using Candidates = std::map<Index, Candidate>;

/// Where a candidate's view stands.
struct Place {
  Eigen::Vector3d position = Eigen::Vector3d::Zero();  ///< of the view (m, world)
  Candidate* candidate = nullptr;                      ///< whose view it is
};

/// The candidates whose views are nearest to a position, nearest first; of equally near ones those that come first in
/// `places`. Cost: O(n + m log m) for n places.
/// @param places of all views
/// @param position m, world
/// @param most number m of candidates that are returned at most
inline std::vector<Candidate*> nearest_views(const std::vector<Place>& places, const Eigen::Vector3d& position,
                                             std::size_t most) {
  std::vector<std::pair<double, std::size_t>> order(places.size());
  for (std::size_t i = 0; i < places.size(); ++i) order[i] = {(places[i].position - position).squaredNorm(), i};
  if (most < order.size()) {
    std::nth_element(order.begin(), order.begin() + static_cast<std::ptrdiff_t>(most), order.end());
    order.resize(most);
  }
  std::sort(order.begin(), order.end());
  std::vector<Candidate*> out;
  out.reserve(order.size());
  for (const auto& [distance, i] : order) out.push_back(places[i].candidate);
  return out;
}

/// Whether a position (m, world) is nearer than `distance` (m) to one of `positions`.
inline bool near_any(const std::vector<Eigen::Vector3d>& positions, const Eigen::Vector3d& position, double distance) {
  return std::any_of(positions.begin(), positions.end(),
                     [&](const Eigen::Vector3d& p) { return (p - position).squaredNorm() < distance * distance; });
}

/// Measure how far the surface reaches at a candidate's frontier, unless that was done in this step.
inline void measure_depth(Candidate& c, const Occluders& occluders, const Parameters& parameters, int step) {
  if (c.depth_step == step) return;
  c.depth = surface_depth<float>(occluders, c.frame, parameters.upsilon);
  c.depth_step = step;
}

/// Whether a candidate's view sees its own frontier, whose depth was measured.
inline bool sees_own(const Candidate& c, const Occluders& occluders, const Parameters& parameters) {
  return is_visible<float>(occluders, c.frame.point, c.depth, c.view.position, parameters, occluders.bounds());
}

/// The nodes of the frontiers that some views see, among those of the tau views nearest to each. A frontier's depth is
/// measured once for all views.
/// @param from whose views look
/// @param all places of all views
/// @param occluders the points
/// @param parameters tau, psi and upsilon are used
/// @param step number of the present step
/// @param threads the result does not depend on it
inline std::vector<Indices> arcs_from(const std::vector<Candidate*>& from, const std::vector<Place>& all,
                                      const Occluders& occluders, const Parameters& parameters, int step, int threads) {
  const auto tau = static_cast<std::size_t>(parameters.max_updates);
  std::vector<std::vector<Candidate*>> near(from.size());
  parallel_for(
      from.size(), threads, [&](std::size_t j) { near[j] = nearest_views(all, from[j]->view.position, tau); }, 1);
  std::vector<Candidate*> each;
  for (const auto& n : near) each.insert(each.end(), n.begin(), n.end());
  std::sort(each.begin(), each.end(), std::less<>());
  each.erase(std::unique(each.begin(), each.end()), each.end());
  parallel_for(
      each.size(), threads, [&](std::size_t j) { measure_depth(*each[j], occluders, parameters, step); }, 16);
  std::vector<Indices> arcs(from.size());
  parallel_for(
      from.size(), threads,
      [&](std::size_t j) {
        const Eigen::Vector3d& eye = from[j]->view.position;
        for (const Candidate* to : near[j])
          if (to != from[j] &&
              is_visible<float>(occluders, to->frame.point, to->depth, eye, parameters, occluders.bounds()))
            arcs[j].push_back(to->node);
      },
      1);
  return arcs;
}

}  // namespace agrisee::see
