// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Baselines that do not look at what they see: a fixed ring of well spread reachable views, and random reachable
/// views.
#pragma once

#include <agrisee/core/random.hpp>
#include <agrisee/plan/directions.hpp>

namespace agrisee::plan {

/// Views chosen once, before the first: `count` reachable directions, each as far as possible from those before it,
/// beginning with the one nearest to frontal (farthest-point sampling); taken in the order of the shortest next move.
class FixedPlanner : public Planner {
 public:
  /// `count` views of the middle of `volume`, about the line from `eye`; distances from `band`.
  FixedPlanner(const Aabb& volume, const Eigen::Vector3d& eye, int count, const ViewRequest& band)
      : volume_(volume), eye_(eye), count_(count), band_(band) {
    band_.target = volume.center();
  }

  void observe(const Progress&) override {}

  std::optional<ReachableView> next(const Progress&, const Joints& current, const Reach& reach) override {
    if (!planned_) plan(current, reach);
    while (!directions_.empty()) {
      std::size_t best = directions_.size();
      std::optional<ReachableView> view;
      for (std::size_t i = 0; i < (first_ ? 1 : directions_.size()); ++i) {
        throw_if_cancelled();
        band_.direction = directions_[i];
        const auto there = reach(band_, current);
        if (there && (!view || there->move_time < view->move_time)) {
          view = there;
          best = i;
        }
      }
      first_ = false;
      if (!view) {
        complete_ = false;
        break;
      }
      directions_.erase(directions_.begin() + static_cast<std::ptrdiff_t>(best));
      return view;
    }
    return std::nullopt;
  }

  void refused() override {}
  StopReason stop_reason() const override { return complete_ ? StopReason::max_views : StopReason::no_reachable_view; }

 private:
  void plan(const Joints& current, const Reach& reach) {
    std::vector<Eigen::Vector3d> reachable;
    for (const Eigen::Vector3d& d : spread_directions(400)) {
      throw_if_cancelled();
      band_.direction = d;
      if (reach(band_, current)) reachable.push_back(d);
    }
    const Eigen::Vector3d frontal = frontal_direction(volume_, eye_);
    Eigen::Vector3d last = frontal;
    std::vector<double> nearest(reachable.size(), 2.0);  // cosine to the nearest chosen; none yet
    for (int n = 0; n < count_ && n < static_cast<int>(reachable.size()); ++n) {
      std::size_t pick = 0;
      for (std::size_t i = 0; i < reachable.size(); ++i) {
        if (n == 0) {
          if (reachable[i].dot(frontal) > reachable[pick].dot(frontal)) pick = i;
        } else {
          const double c = reachable[i].dot(last);
          nearest[i] = n == 1 ? c : std::max(nearest[i], c);
          if (nearest[i] < nearest[pick]) pick = i;
        }
      }
      last = reachable[pick];
      directions_.push_back(last);
    }
    complete_ = static_cast<int>(directions_.size()) == count_;
    planned_ = true;
  }

  Aabb volume_;
  Eigen::Vector3d eye_;
  int count_;
  ViewRequest band_;
  std::vector<Eigen::Vector3d> directions_;
  bool planned_ = false, first_ = true;
  bool complete_ = false;  // all `count` views could be taken
};

/// Random reachable views of the volume's centre, from the front first.
class RandomPlanner : public Planner {
 public:
  /// Views of the middle of `volume` from the side of `eye`; distances from `band`.
  RandomPlanner(const Aabb& volume, const Eigen::Vector3d& eye, const ViewRequest& band, std::uint64_t seed)
      : volume_(volume), eye_(eye), band_(band), rng_(seed, 0x72616e64) {
    band_.target = volume.center();
  }

  void observe(const Progress&) override {}

  std::optional<ReachableView> next(const Progress& progress, const Joints& current, const Reach& reach) override {
    if (progress.views.empty() && !refused_) return first_view(volume_, eye_, current, reach, band_);
    Rng rng = rng_;  // drawn from for good once there is an answer
    std::optional<ReachableView> view;
    for (int tries = 0; tries < 2000 && !view; ++tries) {
      throw_if_cancelled();
      band_.direction = rng.direction();
      view = reach(band_, current);
    }
    rng_ = rng;
    return view;
  }

  void refused() override { refused_ = true; }
  StopReason stop_reason() const override { return StopReason::no_reachable_view; }

 private:
  Aabb volume_;
  Eigen::Vector3d eye_;
  ViewRequest band_;
  Rng rng_;
  bool refused_ = false;
};

}  // namespace agrisee::plan
