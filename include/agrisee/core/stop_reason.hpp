// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Why a scan ended.
#pragma once

namespace agrisee {

/// Why a scan ended.
enum class StopReason {
  not_stopped,        ///< it has not ended
  no_frontier,        ///< nothing worth seeing is left
  no_reachable_view,  ///< the arm can reach no view of what is left, or refused too many (Pipeline::kMostRefusals)
  low_gain,           ///< the expected gain of the best reachable view is below the threshold
  max_views,          ///< the view budget is used up
  nothing_seen,       ///< the first views returned no point inside the scan volume
  camera_hangs        ///< the last frames all equal the one before (Pipeline::kMostRepeats)
};

/// The name of a stop reason, as written to run.json.
inline const char* to_string(StopReason reason) {
  switch (reason) {
    case StopReason::not_stopped:
      return "not_stopped";
    case StopReason::no_frontier:
      return "no_frontier";
    case StopReason::no_reachable_view:
      return "no_reachable_view";
    case StopReason::low_gain:
      return "low_gain";
    case StopReason::max_views:
      return "max_views";
    case StopReason::nothing_seen:
      return "nothing_seen";
    case StopReason::camera_hangs:
      return "camera_hangs";
  }
  return "unknown";
}

}  // namespace agrisee
