// SPDX-License-Identifier: BSD-3-Clause
// Results as files, as `agrisee scan` writes them, without ROS.
#pragma once

#include <agrisee/io/files.hpp>
#include <agrisee/io/parameters.hpp>
#include <agrisee/io/render.hpp>
#include <agrisee/io/scan_page.hpp>
#include <agrisee/version.hpp>

#include <algorithm>

#include "node_parameters.hpp"
#include "scan_session.hpp"

namespace agrisee::robot {

/// Writes the result of every scan into a folder of its own, which is named after the time (UTC) of its first result:
/// OUTPUT/20260321T130755Z.
class ResultWriter {
 public:
  /// @param setup `node.output` is the folder that the results go to, made if necessary; empty: none are written
  /// @throws FileError when it cannot be made
  explicit ResultWriter(const NodeSetup& setup) : output_(setup.node.output) {
    info_.version = AGRISEE_VERSION;
    info_.frame_id = setup.node.world_frame;
    info_.seed = static_cast<std::uint64_t>(setup.node.seed);
    info_.threads = setup.node.threads;
    info_.preset = setup.pipeline.preset;
    info_.planner = setup.pipeline.planner;
    info_.parameters_json = io::parameters_to_json(setup.pipeline);
    if (!output_.empty()) io::make_folder(output_);
  }

  /// Writes the result of a session whose scan is done or was stopped, unless it is written already. That of a scan
  /// that went on after a stop replaces the earlier one.
  /// @return the scan's folder; empty when nothing was written
  /// @throws FileError, InputError as io::write_result does
  std::filesystem::path write(const ScanSession& session, const ScanResult& result) {
    const bool over = session.state() == SessionState::done || session.state() == SessionState::paused;
    if (output_.empty() || !over || result.views.empty()) return {};
    if (session.scans() != scan_) {
      folder_.clear();
      views_ = 0;
      scan_ = session.scans();
    }
    if (result.views.size() == views_ && session.state() == state_) return {};
    if (folder_.empty()) folder_ = new_folder();
    const Workcell& workcell = session.pipeline().workcell();
    info_.scene = workcell.name;
    info_.time = io::utc_now();
    io::write_result(folder_, result, info_);
    io::write_scan_page(folder_ / io::kReport, result, workcell, info_);
    io::write_picture(folder_ / io::kPicture, result, workcell);
    views_ = result.views.size();
    state_ = session.state();
    return folder_;
  }

 private:
  /// One that does not exist yet.
  std::filesystem::path new_folder() const {
    std::string name = io::utc_now();
    name.erase(std::remove_if(name.begin(), name.end(), [](char c) { return c == '-' || c == ':'; }), name.end());
    std::filesystem::path folder = output_ / name;
    std::error_code error;
    for (int i = 2; std::filesystem::exists(folder, error); ++i) folder = output_ / (name + "-" + std::to_string(i));
    return folder;
  }

  std::filesystem::path output_;
  io::RunInfo info_;
  std::filesystem::path folder_;             // of the last result
  std::size_t scan_ = 0;                     // which scan it is of
  std::size_t views_ = 0;                    // that it holds, once it is complete
  SessionState state_ = SessionState::idle;  // in which it was written
};

}  // namespace agrisee::robot
