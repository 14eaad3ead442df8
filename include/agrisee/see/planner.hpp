// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// SEE++ (Border & Gammell, IJRR 2024; [1], 3.2.1): merge a view, propose a view for each frontier, choose one of
/// them, and look at a frontier again or give it up. World frame, metres.
///
/// ```
/// Explorer explorer(Parameters::published());
/// explorer.observe(points, sensor_position);                       // a first view, chosen by the caller
/// while (auto view = explorer.next_view(sensor_position, reachable))
///   explorer.observe(points_from(*view), sensor_position = ...);   // wherever the sensor really went
/// explorer.stop_reason();                                          // why there is no further view
/// ```
/// It does not know the robot: `reachable` says which proposals can be reached. It ends after at most `max_views`
/// views. Cost per step: one frame for each new frontier and each of the tau nearest, and tau^2 lines of sight. Defined
/// in `agrisee::agrisee`.
#pragma once

#include <agrisee/core/stop_reason.hpp>
#include <agrisee/neighbors/grid.hpp>
#include <agrisee/see/candidates.hpp>
#include <agrisee/see/density.hpp>
#include <agrisee/see/view_controller.hpp>
#include <agrisee/see/visibility_graph.hpp>

namespace agrisee::see {

/// Chooses the next view, again and again, until nothing is left to see.
class Explorer {
 public:
  /// @param parameters of SEE++
  /// @param threads the results do not depend on it
  /// @throws FieldError if a parameter is out of its range
  explicit Explorer(const Parameters& parameters, int threads = 1)
      : parameters_(parameters), threads_(threads), map_(parameters), occluders_(parameters.upsilon) {}

  /// Merge the points of a view.
  /// @param cloud points of the view, any cloud type (m, world); may be empty
  /// @param sensor position of the sensor (m, world)
  /// @return indices of the points that were kept, ascending
  /// @throws InputError if `sensor` is not finite
  template <typename C>
  Indices observe(const C& cloud, const Eigen::Vector3d& sensor) {
    return observe(cloud, cloud, sensor);
  }

  /// The same for a caller that merges views itself.
  /// @param cloud points of the view that are to be kept, any cloud type (m, world)
  /// @param observation all points of the view (m, world)
  template <typename C, typename O>
  Indices observe(const C& cloud, const O& observation, const Eigen::Vector3d& sensor) {
    check_input(sensor.allFinite(), "see::Explorer::observe: the sensor's position is not finite");
    const std::size_t before = map_.size();
    const Indices kept = map_.insert(cloud, views_taken(), threads_);
    sensors_.push_back(sensor);
    seen_ = Observation(observation, sensor);
    states_.resize(map_.size());
    unreachable_.resize(map_.size(), 0);
    index_points(before);
    observed_ = true;
    return kept;
  }

  /// Remove all points but `kept` (indices of cloud(), ascending). For filters that run between views.
  /// @throws InputError if an index is out of range
  void keep(const Indices& kept);

  /// The view to take next; empty if there is none, see stop_reason(). If it cannot be reached, move_view() or refuse()
  /// it and call again. The first call after a view updates the frontiers and the views nearest to the sensor.
  /// @param sensor present position of the sensor (m, world)
  /// @throws InputError if `sensor` is not finite
  std::optional<ViewProposal> next_view(const Eigen::Vector3d& sensor);

  /// Take the best view that can be reached, and refuse the better ones.
  /// @param sensor present position of the sensor (m, world)
  /// @param reachable bool(const ViewProposal&)
  /// @return empty if no view is left, see stop_reason()
  /// @throws InputError if `sensor` is not finite
  template <typename Reachable>
  std::optional<ViewProposal> next_view(const Eigen::Vector3d& sensor, Reachable&& reachable) {
    while (const auto view = next_view(sensor)) {
      if (reachable(*view)) {
        take(*view);
        return view;
      }
      refuse(*view);
    }
    return std::nullopt;
  }

  /// This view is taken next: the next observe() gets its points.
  void take(const ViewProposal& view) { target_ = view.frontier; }

  /// Whether the line of sight from a view's frontier to a position (m, world) is free.
  bool sees(const ViewProposal& view, const Eigen::Vector3d& position) const;

  /// The sensor will look at the view's frontier from another position (m, world), because it cannot reach the view's.
  void move_view(const ViewProposal& view, const Eigen::Vector3d& position);

  /// This view cannot be reached: its frontier is given up.
  void refuse(const ViewProposal& view);

  /// Why next_view() last returned no view; not_stopped before that.
  StopReason stop_reason() const { return stop_reason_; }
  /// Number of views observed so far.
  int views_taken() const { return static_cast<int>(sensors_.size()); }
  /// The merged points with their views, densities and classes.
  const DensityMap<float>& map() const { return map_; }
  const Cloud& cloud() const { return map_.cloud(); }           ///< the points merged so far
  const Parameters& parameters() const { return parameters_; }  ///< those it was made with
  /// The frontiers as of the last next_view(), by ascending index, with their frames.
  std::vector<Frontier> frontiers() const;

 private:
  /// Update sum and searches with the points from index `begin` on.
  void index_points(std::size_t begin);

  const Grid<float>& search();

  const Eigen::Vector3d& first_sensor(Index i) const;

  /// Frames and views for the points that became frontiers; points that are no longer frontiers are dropped.
  void update_frontiers();

  /// Frames of points; empty where there is none.
  std::vector<std::optional<Frontier>> frames_of(const Indices& points);

  /// Decide what to do with the frontier of the last view, if it is still a frontier.
  void control();

  /// Let the controller change a candidate's view. A change that leaves it nearer than min_move to where the sensor was
  /// would show the same again: it counts as one that did not help. That is so where the offset o is along the normal,
  /// for then an adjustment moves nothing, and mostly after a switch.
  /// @return false if nothing helps
  bool look_elsewhere(Candidate& c);

  /// Renew the frames of the views nearest to the sensor, move those views that do not see their frontiers, give up
  /// those frontiers that cannot be seen at all, and update the graph for the views nearest to the sensor.
  void update_views(const Eigen::Vector3d& sensor);

  /// Estimate the frames of candidates anew, as the points around them are now. Views go with the normals, except for
  /// those that the controller has moved. SEE++ estimates a frame once, when the point becomes a frontier. Then few
  /// points beyond the edge are known, and the normal leans towards what had been seen.
  void renew(const std::vector<Candidate*>& candidates);

  bool valid(const Frontier& f) const;

  /// The views of the valid frontiers, in the order of these.
  std::vector<Place> places();

  /// The views of the valid frontiers that are no nearer than min_move to where the sensor was; if there are none, all.
  std::vector<Place> new_places();

  /// The frontier whose view is selected; empty if there is none. A view that the controller has just changed comes
  /// first if `adjusted_first` is set: SEE++ lets it compete, but then the sensor creeps, because with tau views in its
  /// neighborhood a nearer one is always found.
  std::optional<Index> choose(const Eigen::Vector3d& sensor);

  void remove(Candidates::iterator c);
  void give_up(Index i);

  std::nullopt_t stop(StopReason reason);
  StopReason why_stop() const;

  Parameters parameters_;
  int threads_;
  DensityMap<float> map_;
  Occluders occluders_;                            // the points, for lines of sight
  std::optional<Grid<float>> search_;              // the points, for frames; made when needed
  Eigen::Vector3d sum_ = Eigen::Vector3d::Zero();  // of all points
  std::vector<Eigen::Vector3d> sensors_;           // position of each view
  Observation seen_;                               // the last view
  Candidates candidates_;
  VisibilityGraph graph_;
  std::vector<ControllerState> states_;  // per point
  std::vector<char> unreachable_;        // per point: whether it was given up because its view cannot be reached
  std::optional<Index> target_;          // the frontier that the present view was taken for
  std::optional<Index> changed_;         // the frontier whose view comes next because the controller changed it
  bool observed_ = false;                // whether a view was merged since the last next_view()
  int step_ = 0;                         // number of views that next_view() has dealt with
  StopReason stop_reason_ = StopReason::not_stopped;
};

}  // namespace agrisee::see
