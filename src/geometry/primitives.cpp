// SPDX-License-Identifier: BSD-3-Clause
#include <agrisee/geometry/primitives.hpp>

namespace agrisee {

void KeepOut::check() const {
  const auto check_length = [&](const char* what, double value) {
    const bool ok = value > 0.0 && std::isfinite(value);  // the name is made for an error alone
    if (!ok) check_parameter(ok, ("keep_out '" + name + "': " + what).c_str(), "positive and finite", value);
  };
  if (const Box* box = std::get_if<Box>(&shape)) {
    for (int a = 0; a < 3; ++a) check_length("size", box->size[a]);
    if (!box->center.allFinite()) throw ParameterError("keep_out '" + name + "': center must be finite");
  } else if (const Cylinder* c = std::get_if<Cylinder>(&shape)) {
    check_length("radius", c->radius);
    check_length("height", c->height);
    if (!c->center.allFinite()) throw ParameterError("keep_out '" + name + "': center must be finite");
  }
}

double distance(const Box& box, const Eigen::Vector3d& p) {
  return ((p - box.center).cwiseAbs() - 0.5 * box.size).cwiseMax(0.0).norm();
}

double distance(const Cylinder& c, const Eigen::Vector3d& p) {
  const Eigen::Vector3d d = p - c.center;
  return std::hypot(std::max(std::hypot(d.x(), d.y()) - c.radius, 0.0),
                    std::max(std::abs(d.z()) - 0.5 * c.height, 0.0));
}

double distance(const KeepOut& k, const Eigen::Vector3d& p) {
  return std::visit([&](const auto& shape) { return distance(shape, p); }, k.shape);
}

double distance(const Box& box, const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  const Eigen::Vector3d p = a - box.center, d = b - a, h = 0.5 * box.size;
  const auto slope = [&](double t) {
    double sum = 0.0;
    for (int i = 0; i < 3; ++i) {
      const double x = p[i] + t * d[i];
      sum += d[i] * (x - std::clamp(x, -h[i], h[i]));
    }
    return sum;
  };
  double lo = 0.0, hi = 1.0, at_lo = slope(0.0), at_hi = slope(1.0);
  if (at_lo >= 0.0) return distance(box, a);
  if (at_hi <= 0.0) return distance(box, b);
  for (int i = 0; i < 3; ++i) {
    if (d[i] == 0.0) continue;
    for (const double face : {-h[i], h[i]}) {
      const double t = (face - p[i]) / d[i];
      if (!(t > lo && t < hi)) continue;
      const double at = slope(t);
      if (at <= 0.0)
        lo = t, at_lo = at;
      else
        hi = t, at_hi = at;
    }
  }
  return distance(box, Eigen::Vector3d(a + (lo + (hi - lo) * at_lo / (at_lo - at_hi)) * d));
}

double distance(const Cylinder& c, const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  const Eigen::Vector3d p = a - c.center, d = b - a;
  const double half = 0.5 * c.height, across_sq = d.x() * d.x() + d.y() * d.y();
  double curvature = 0.0;
  const auto slope = [&](double t) {  // half the first derivative; sets `curvature` to half the second
    const double x = p.x() + t * d.x(), y = p.y() + t * d.y(), z = p.z() + t * d.z();
    const double rho = std::sqrt(x * x + y * y), out = rho - c.radius, over = z - std::clamp(z, -half, half);
    double sum = d.z() * over;
    curvature = over != 0.0 ? d.z() * d.z() : 0.0;
    if (out > 0.0 && rho > 0.0) {
      const double speed = (x * d.x() + y * d.y()) / rho;
      sum += out * speed;
      curvature += speed * speed + out * (across_sq - speed * speed) / rho;
    }
    return sum;
  };
  double t = 0.0, at = slope(0.0);
  if (at >= 0.0) return distance(c, a);
  const double newton_from_a = -at / curvature;  // the slope is not zero here, so the curvature is not either
  if (slope(1.0) <= 0.0) return distance(c, b);
  double lo = 0.0, hi = 1.0;
  t = newton_from_a < 1.0 ? newton_from_a : 0.5;
  for (int i = 0; i < 60; ++i) {
    at = slope(t);
    if (at == 0.0) break;
    (at < 0.0 ? lo : hi) = t;
    const double step = t - at / curvature;
    const double next = step > lo && step < hi ? step : 0.5 * (lo + hi);
    const bool settled = std::abs(next - t) < 1e-14;
    t = next;
    if (settled) break;
  }
  return distance(c, Eigen::Vector3d(a + t * d));
}

double distance(const KeepOut& k, const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  return std::visit([&](const auto& shape) { return distance(shape, a, b); }, k.shape);
}

double segment_distance(const Eigen::Vector3d& p1, const Eigen::Vector3d& q1, const Eigen::Vector3d& p2,
                        const Eigen::Vector3d& q2) {
  const auto clamp01 = [](double x) { return std::clamp(x, 0.0, 1.0); };
  const Eigen::Vector3d d1 = q1 - p1, d2 = q2 - p2, r = p1 - p2;
  const double a = d1.squaredNorm(), e = d2.squaredNorm(), f = d2.dot(r), c = d1.dot(r), b = d1.dot(d2);
  constexpr double kTiny = 1e-18;
  double s = 0.0, t = 0.0;
  if (a <= kTiny && e <= kTiny) return r.norm();
  if (a <= kTiny) {
    t = clamp01(f / e);
  } else if (e <= kTiny) {
    s = clamp01(-c / a);
  } else {
    const double denominator = a * e - b * b;
    s = denominator > kTiny ? clamp01((b * f - c * e) / denominator) : 0.0;
    t = (b * s + f) / e;
    if (t < 0.0) {
      t = 0.0;
      s = clamp01(-c / a);
    } else if (t > 1.0) {
      t = 1.0;
      s = clamp01((b - c) / a);
    }
  }
  return (p1 + s * d1 - p2 - t * d2).norm();
}

}  // namespace agrisee
