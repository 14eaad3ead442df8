// SPDX-License-Identifier: BSD-3-Clause
#include "archive.hpp"

#include <agrisee/version.hpp>

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
  a(p.order, p.reachable, p.reason, p.direction, p.world_T_pre_grasp, p.joints, p.after);
}
template <typename A>
void members(A& a, Ripeness& r) {
  a(r.lab, r.hue, r.hue_error, r.ripe_share, r.ripe_share_error, r.grade, r.probability, r.points);
}
template <typename A>
void members(A& a, Fruit& f) {
  a(f.id, f.truss, f.points, f.found_by, f.centroid, f.centroid_cluster, f.sigma, f.orientation, f.body, f.picking,
    f.ripeness);
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

/// Whether the bytes of a T are its value.
template <typename T>
constexpr bool is_plain = std::is_arithmetic_v<T> || std::is_enum_v<T>;
template <typename S, int R, int C>
constexpr bool is_plain<Eigen::Matrix<S, R, C>> = R > 0 && C > 0;
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
    check_input(n <= static_cast<std::size_t>(end_ - at_), "a pickled result is cut off");
    if (n > 0) std::memcpy(p, at_, n);
    at_ += n;
  }
  std::size_t count() {
    std::size_t n = 0;
    bytes(&n, sizeof n);
    check_input(n <= static_cast<std::size_t>(end_ - at_), "a pickled result is cut off");
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
  check_input(bytes.compare(0, kHead.size(), kHead) == 0, "a pickled result is of another version");
  const std::string rest = bytes.substr(kHead.size());
  Reader in(rest);
  T value;
  in(value);
  check_input(in.at_end(), "a pickled result is too long");
  return value;
}

template std::string to_bytes(const ScanResult&);
template std::string to_bytes(const Fruit&);
template std::string to_bytes(const View&);
template ScanResult from_bytes(const std::string&);
template Fruit from_bytes(const std::string&);
template View from_bytes(const std::string&);

}  // namespace agrisee::python
