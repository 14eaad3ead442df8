// SPDX-License-Identifier: BSD-3-Clause
#include "archive.hpp"

#include <agrisee/cloud/fit.hpp>
#include <agrisee/cloud/icp.hpp>
#include <agrisee/plan/planner.hpp>
#include <agrisee/result.hpp>
#include <agrisee/version.hpp>
#include <agrisee/workcell.hpp>

#include <cstring>
#include <type_traits>

namespace agrisee::python {
namespace {

// The members of each struct, in one place for writing and reading.
template <typename A>
void members(A& a, View& v) {
  a(v.world_T_optical, v.target, v.joints, v.median_depth, v.volume_distance, v.points_in, v.points_new, v.plan_seconds,
    v.discarded, v.discard_reason);
}
template <typename A>
void members(A& a, Body& b) {
  a(b.center, b.radii, b.axes, b.center_covariance, b.center_covariance_by_shape, b.rms, b.completeness, b.confidence,
    b.volume, b.volume_error, b.volume_error_by_shape, b.mass, b.mass_error);
}
template <typename A>
void members(A& a, Picking& p) {
  a(p.order, p.reachable, p.reason, p.direction, p.world_T_pre_grasp, p.joints, p.after, p.crossed);
}
template <typename A>
void members(A& a, Ripeness& r) {
  a(r.lab, r.hue, r.hue_error, r.ripe_share, r.ripe_share_error, r.grade, r.probability, r.points);
}
template <typename A>
void members(A& a, Fruit& f) {
  a(f.id, f.truss, f.points, f.found_by, f.centroid, f.centroid_cluster, f.sigma, f.orientation, f.body, f.picking,
    f.ripeness, f.growth_axis_error);
}
template <typename A>
void members(A& a, FoundTruss& t) {
  a(t.id, t.fruits, t.world_T_truss, t.ripeness);
}
template <typename A>
void members(A& a, Completeness::Part& p) {
  a(p.center, p.seen, p.observable);
}
template <typename A>
void members(A& a, Completeness& c) {
  a(c.fruits, c.seen, c.observable);
}
template <typename A>
void members(A& a, Cloud& c) {
  a(c.points, c.normals, c.views, c.colors, c.instances);
}
template <typename A>
void members(A& a, ScanResult& r) {
  a(r.views, r.stop_reason, r.raw, r.cloud, r.labels, r.cluster_origin, r.fruits, r.trusses, r.completeness, r.seconds,
    r.warnings, r.bodies);
}
template <typename A>
void members(A& a, Timing& t) {
  Timing::fields(t, [&](const char*, auto& field) { a(field); });
}
template <typename A>
void members(A& a, BodyCounts& b) {
  BodyCounts::fields(b, [&](const char*, auto& field) { a(field); });
}
template <typename A>
void members(A& a, IcpResult& r) {
  a(r.target_T_source, r.accepted, r.rms_before, r.rms_after, r.worse, r.matches_before, r.matches, r.iterations,
    r.constrained, r.translation, r.rotation);
}
template <typename A>
void members(A& a, SizePrior& p) {
  a(p.radius, p.spread);
}
template <typename A>
void members(A& a, EllipsoidFit& f) {
  a(f.body.center, f.body.A, f.center_covariance, f.center_covariance_by_shape, f.shape_covariance, f.rms, f.inliers,
    f.size_prior);
}
template <typename A>
void members(A& a, plan::ViewRequest& r) {
  a(r.target, r.direction, r.distance, r.distance_min, r.distance_max);
}
template <typename A>
void members(A& a, plan::ReachableView& v) {
  a(v.world_T_optical, v.target, v.joints, v.move_time, v.gain);
}
template <typename A>
void members(A& a, sensor::DepthCamera& c) {
  sensor::Intrinsics& k = c.intrinsics;
  a(k.width, k.height, k.fx, k.fy, k.cx, k.cy, c.range_min, c.range_max, c.max_incidence, c.housing_radius,
    c.housing_depth);
}
template <typename A>
void members(A& a, KeepOut& k) {
  bool is_box = std::holds_alternative<Box>(k.shape);
  a(k.name, is_box);
  if (!is_box && std::holds_alternative<Box>(k.shape)) k.shape = Cylinder();  // one that is being read
  if (auto* box = std::get_if<Box>(&k.shape)) a(box->center, box->size);
  if (auto* cylinder = std::get_if<Cylinder>(&k.shape)) a(cylinder->center, cylinder->radius, cylinder->height);
}
template <typename A>
void members(A& a, Workcell& w) {
  std::string arm(w.arm.name);  // workcells of Python have no arms but the models
  a(w.name, arm, w.world_T_base, w.tool0_T_optical, w.tool0_T_tool, w.start, w.sensor, w.scan_volume.min,
    w.scan_volume.max, w.keep_out);
  if (arm != w.arm.name) w.arm = arm::ur_model(arm);  // one that is being read
}

/// Whether the bytes of a T are its value.
template <typename T>
constexpr bool is_plain = std::is_arithmetic_v<T> || std::is_enum_v<T>;
template <typename S, int R, int C, int O>
constexpr bool is_plain<Eigen::Matrix<S, R, C, O>> = R > 0 && C > 0;
template <>
constexpr bool is_plain<Rgb> = true;

class Writer {
 public:
  explicit Writer(std::string& out) : out_(out) {}
  template <typename... T>
  void operator()(const T&... values) {
    (put(values), ...);
  }

 private:
  void bytes(const void* p, std::size_t n) { out_.append(static_cast<const char*>(p), n); }
  void count(std::size_t n) { bytes(&n, sizeof n); }
  template <typename T>
  void put(const T& value) {
    if constexpr (is_plain<T>)
      bytes(&value, sizeof value);
    else
      members(*this, const_cast<T&>(value));  // only read
  }
  void put(const Pose& pose) { bytes(pose.data(), 16 * sizeof(double)); }
  void put(const std::string& text) {
    count(text.size());
    bytes(text.data(), text.size());
  }
  template <typename T>
  void put(const std::optional<T>& value) {
    put(value.has_value());
    if (value) put(*value);
  }
  template <typename T>
  void put(const std::vector<T>& values) {
    count(values.size());
    if constexpr (is_plain<T>)
      bytes(values.data(), values.size() * sizeof(T));
    else
      for (const T& value : values) put(value);
  }

  std::string& out_;
};

class Reader {
 public:
  explicit Reader(const std::string& in) : at_(in.data()), end_(in.data() + in.size()) {}
  template <typename... T>
  void operator()(T&... values) {
    (get(values), ...);
  }
  bool at_end() const { return at_ == end_; }

 private:
  void bytes(void* p, std::size_t n) {
    check_input(n <= static_cast<std::size_t>(end_ - at_), "a pickled object is cut off");
    if (n > 0) std::memcpy(p, at_, n);
    at_ += n;
  }
  std::size_t count() {
    std::size_t n = 0;
    bytes(&n, sizeof n);
    check_input(n <= static_cast<std::size_t>(end_ - at_), "a pickled object is cut off");
    return n;
  }
  template <typename T>
  void get(T& value) {
    if constexpr (is_plain<T>)
      bytes(&value, sizeof value);
    else
      members(*this, value);
  }
  void get(Pose& pose) { bytes(pose.data(), 16 * sizeof(double)); }
  void get(std::string& text) {
    text.resize(count());
    bytes(text.data(), text.size());
  }
  template <typename T>
  void get(std::optional<T>& value) {
    bool there = false;
    get(there);
    if (there) get(value.emplace());
  }
  template <typename T>
  void get(std::vector<T>& values) {
    values.resize(count());
    if constexpr (is_plain<T>)
      bytes(values.data(), values.size() * sizeof(T));
    else
      for (T& value : values) get(value);
  }

  const char *at_, *end_;
};

/// What bytes of this version begin with.
const std::string kHead = "agrisee " AGRISEE_VERSION "\n";

}  // namespace

template <typename T>
std::string to_bytes(const T& value) {
  std::string out = kHead;
  Writer writer(out);
  writer(value);
  return out;
}

template <typename T>
T from_bytes(const std::string& bytes) {
  check_input(bytes.compare(0, kHead.size(), kHead) == 0, "a pickled object is of another version");
  const std::string rest = bytes.substr(kHead.size());
  Reader in(rest);
  T value;
  in(value);
  check_input(in.at_end(), "a pickled object is too long");
  return value;
}

template std::string to_bytes(const ScanResult&);
template std::string to_bytes(const Fruit&);
template std::string to_bytes(const View&);
template std::string to_bytes(const Body&);
template std::string to_bytes(const Picking&);
template std::string to_bytes(const FoundTruss&);
template std::string to_bytes(const IcpResult&);
template std::string to_bytes(const EllipsoidFit&);
template std::string to_bytes(const Workcell&);
template std::string to_bytes(const plan::ViewRequest&);
template std::string to_bytes(const plan::ReachableView&);
template ScanResult from_bytes(const std::string&);
template Fruit from_bytes(const std::string&);
template View from_bytes(const std::string&);
template Body from_bytes(const std::string&);
template Picking from_bytes(const std::string&);
template FoundTruss from_bytes(const std::string&);
template IcpResult from_bytes(const std::string&);
template EllipsoidFit from_bytes(const std::string&);
template Workcell from_bytes(const std::string&);
template plan::ViewRequest from_bytes(const std::string&);
template plan::ReachableView from_bytes(const std::string&);

}  // namespace agrisee::python
