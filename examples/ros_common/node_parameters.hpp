// SPDX-License-Identifier: BSD-3-Clause
// The parameters of a scan node and of what it runs, read from a parameter server; without ROS.
#pragma once

#include "frame_matcher.hpp"
#include "read_parameters.hpp"
#include "scan_session.hpp"

namespace agrisee::robot {

/// The parameters of the node itself; docs/ros.md describes them.
struct NodeParameters {
  std::string workcell, world_frame = "world", optical_frame, joint_prefix, output;
  bool rectified = false, autostart = false;
  int seed = 0, threads = 1;
  double speed = 1.0;
  SessionParameters arrival;
  ChannelParameters channels;

  /// f(name, field, range) for every field.
  template <typename P, typename F>
  static void fields(P& p, F&& f) {
    f("workcell", p.workcell);
    f("world_frame", p.world_frame);
    f("optical_frame", p.optical_frame);
    f("joint_prefix", p.joint_prefix);
    f("output", p.output);
    f("rectified", p.rectified);
    f("autostart", p.autostart);
    f("seed", p.seed, Range::not_negative());
    f("threads", p.threads, Range::at_least(1));
    f("speed", p.speed, Range::above(0.0).up_to(1.0));
    f("arrival", p.arrival);
    f("channels", p.channels);
  }
};

/// All parameters of a scan node.
struct NodeSetup {
  NodeParameters node;
  Parameters pipeline;
};

/// Reads all parameters by `lookup` (see FieldReader), which is then asked to `refuse_unknown(names)`.
/// @param separator between a group and its fields: "/" in ROS 1, "." in ROS 2
/// @throws ParameterError that names the parameter which is missing, unknown, of a wrong type or out of its range
template <typename Lookup>
NodeSetup read_setup(Lookup& lookup, const std::string& separator) {
  NodeSetup setup;
  std::set<std::string> known{"preset"};
  NodeParameters::fields(setup.node, FieldReader<Lookup>(lookup, "", separator, known));
  setup.pipeline = read_parameters(lookup, separator, known);
  lookup.refuse_unknown(known);
  check_fields(setup.node, "", separator);
  if (setup.node.workcell.empty())
    throw ParameterError("parameter 'workcell' has to name a scene file (robot, sensor, scan_volume, keep_out)");
  return setup;
}

}  // namespace agrisee::robot
