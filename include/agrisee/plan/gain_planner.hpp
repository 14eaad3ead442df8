// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// The default planner: of the views that the arm can take, it chooses the one that promises the most new fruit surface
/// for the time it costs.
///
/// The first view looks at the middle of the scan volume, from the front. While views show nothing, others follow, of
/// each part of a volume that is larger than the image, and four at least; if the arm can look at the middle of none,
/// the parts are halved.
///
/// Candidate views look at points spread over the extent of the fruit, from directions spread over the sphere and from
/// various distances; those out of reach are dropped. A candidate's score is its ExpectedSurface::gain divided by the
/// time for dwelling and moving. Where joints are reported, a move counts the distance from the present joints (the
/// root of the sum of squares) at pi rad/s, whatever `move_time` says; where they are not, it counts the `move_time`
/// that the arm last answered for the view, which for most candidates is of an earlier call. The reach of the best
/// candidates is computed again from the arm's present joints: those that it can no longer take are dropped, and
/// directions close to theirs are tried as well, and then closer ones about the best of all. The scan ends when the
/// best view promises less than `min_gain` of the fruit surface known so far, which counts as at least that of one
/// fruit of middle size (radius sqrt(radius_min radius_max)). Promises are scaled by ExpectedSurface::reliability,
/// because views among leaves show less than they promise, and by ExpectedSurface::clearness, because close to a view
/// that something unknown blocked others are blocked, too. World frame, metres, seconds.
#pragma once

#include <agrisee/plan/expected_surface.hpp>
#include <agrisee/plan/planner.hpp>

namespace agrisee::plan {

/// Chooses the view with the best expected gain for its time; the head of this file describes how.
class GainPlanner : public Planner {
 public:
  /// @param sensor intrinsics and range of the camera
  /// @param volume to be scanned (world)
  /// @param robot position of the robot's base (m, world); the first view looks from there
  /// @param split how the cloud is segmented into fruit
  /// @param free_space how sight lines are interpreted
  /// @param parameters see their struct
  /// @param threads the choice does not depend on it
  /// @throws ParameterError
  GainPlanner(const sensor::DepthCamera& sensor, const Aabb& volume, const Eigen::Vector3d& robot,
              const SplitParameters& split, const fuse::FreeSpaceParameters& free_space,
              const GainPlannerParameters& parameters = {}, int threads = 1);

  void observe(const Progress& progress) override;
  std::optional<ReachableView> next(const Progress& progress, const Joints& current, const Reach& reach) override;
  void refused() override;
  StopReason stop_reason() const override { return reason_; }
  std::optional<Completeness> completeness() const override { return completeness_; }
  std::vector<ReachableView> candidates() const override;

  /// The planner's model of the fruit.
  const ExpectedSurface& model() const { return model_; }

 private:
  struct Candidate {
    ViewRequest request;
    ReachableView view;
  };
  struct Scored {
    ViewRequest request;
    ReachableView view;
    std::vector<std::uint32_t> shown;  // unseen samples of the model that the view shows
    bool rated = false;                // `shown` is known for this view
    bool lost = false;                 // the arm can no longer take it
    double score = 0.0;                // gain over time (m2/s)
  };
  struct Part {
    Aabb box;
    int looks = 0;  // views that looked at it
  };

  /// A view near the front, while nothing has been seen.
  std::optional<ReachableView> front_view(int taken, const Joints& current, const Reach& reach);
  /// A view of the part of the volume that was looked at least, of those whose middle the arm can look at.
  std::optional<ReachableView> view_of_part(int taken, const Joints& current, const Reach& reach);
  /// Divide the volume into parts that are as wide as a view shows, times a factor.
  void divide(double factor);
  /// Find the candidates anew when the extent of the fruit has changed by more than 2 cm.
  void update_candidates(const Joints& current, const Reach& reach);
  /// Request for a view of the model's center along `direction`.
  ViewRequest request(const Eigen::Vector3d& direction) const;

  /// Drop the first views of `ranked_`, up to the first that the arm can take from its present joints, and rate that
  /// one anew; false, with nothing dropped, if it can take none.
  bool first_within_reach(const Joints& current, const Reach& reach);
  /// Fill `ranked_` with the views worth taking, best first, and set `completeness_`; returns the reason when there is
  /// none.
  std::optional<StopReason> rank(const Joints& current, const Reach& reach);
  /// Ask again for the best of `ranked_` from the present joints, mark the lost ones, and add directions close to all,
  /// then closer ones to the best of these.
  void refine(const Joints& current, const Reach& reach);
  /// Add the views like one (a copy, as `ranked_` grows) from six directions around its own.
  /// @param step how far away they are (rad)
  void consider_around(ViewRequest middle, double step, const Joints& current, const Reach& reach);
  /// Drop the refused views from `ranked_` and score the others from the present joints.
  void rank_again(const Joints& current);
  /// Drop the views of `left_out_` from `ranked_`.
  void leave_out();
  void sort_ranked();
  /// Add a view to `ranked_`, to be rated by rate_from.
  void consider(const ViewRequest& request, const ReachableView& view);
  /// Rate the views of `ranked_` from this number on.
  void rate_from(std::size_t first, const Joints& current);
  /// Set a view and compute what it shows, its gain and its score.
  void rate(Scored& scored, const ReachableView& view, const Joints& current) const;
  bool is_left_out(const ViewRequest& request) const;
  /// The smallest promised gain (m2) that is worth a view.
  double least_gain() const;

  /// Answer with nothing, now and whenever the arm asks again from these joints.
  std::optional<ReachableView> stop(StopReason reason, const Joints& current);

  GainPlannerParameters parameters_;
  SplitParameters split_;
  fuse::FreeSpaceParameters free_space_;
  Aabb volume_;
  Eigen::Vector3d robot_;
  ExpectedSurface model_;
  int threads_;
  double look_ = 0.0;                // width that a view shows (m)
  std::vector<Part> parts_;          // of the volume, to look at while nothing has been seen
  std::optional<std::size_t> part_;  // at which the view last returned looks
  std::vector<Candidate> candidates_;
  Aabb extent_;                 // of the fruit when the candidates were made
  std::vector<Scored> ranked_;  // views worth taking after the last frame, best first; empty until they are rated
  std::vector<ViewRequest> left_out_;   // the last one taken, and those refused since
  std::optional<ViewRequest> last_;     // the request of the view last returned, unless it was refused
  Joints asked_from_ = Joints::Zero();  // the joints for which it was returned
  std::optional<Completeness> completeness_;
  int refused_ = 0;                   // views refused since the last frame; the front view skips as many
  std::optional<Joints> stopped_at_;  // the joints for which nothing was returned since
  StopReason reason_ = StopReason::not_stopped;
};

}  // namespace agrisee::plan
