// SPDX-License-Identifier: BSD-3-Clause
#include <agrisee/arm/ur.hpp>

namespace agrisee::arm {

LinkFrames link_frames(const Joints& q, const UrModel& model) {
  check_input(q.allFinite(), "arm: a joint angle is not finite");
  const Eigen::Vector3d up = Eigen::Vector3d::UnitZ();
  const double c1 = std::cos(q[0]), s1 = std::sin(q[0]);
  const Eigen::Vector3d out(-c1, -s1, 0.0),
      n(-s1, c1, 0.0);  // horizontal direction and normal of the arm's vertical plane
  LinkFrames f;
  const auto set = [&](std::size_t i, const Eigen::Vector3d& x, const Eigen::Vector3d& y, const Eigen::Vector3d& z,
                       const Eigen::Vector3d& origin) { f[i].matrix() << x, y, z, origin, 0.0, 0.0, 0.0, 1.0; };
  Eigen::Vector3d p(0.0, 0.0, model.d1);
  set(0, out, -n, up, p);
  const auto in_plane = [&](std::size_t i, double angle) {
    const double c = std::cos(angle), s = std::sin(angle);
    set(i, c * out + s * up, -s * out + c * up, n, p);
  };
  in_plane(1, q[1]);
  p += model.a2 * f[1].linear().col(0);
  in_plane(2, q[1] + q[2]);
  p += model.a3 * f[2].linear().col(0) + model.d4 * n;
  in_plane(3, q[1] + q[2] + q[3]);
  const Eigen::Vector3d x4 = f[3].linear().col(0), z5 = -f[3].linear().col(1);
  p += model.d5 * z5;
  const double c5 = std::cos(q[4]), s5 = std::sin(q[4]);
  const Eigen::Vector3d x5 = c5 * x4 + s5 * n, y5 = -s5 * x4 + c5 * n;
  set(4, x5, y5, z5, p);
  p += model.d6 * y5;
  const double c6 = std::cos(q[5]), s6 = std::sin(q[5]);
  set(5, c6 * x5 - s6 * z5, -s6 * x5 - c6 * z5, y5, p);
  return f;
}

Pose forward(const Joints& q, const UrModel& model) { return link_frames(q, model)[5]; }

Matrix6 jacobian(const Joints& q, const UrModel& model) {
  const LinkFrames f = link_frames(q, model);
  Matrix6 j;
  for (std::size_t i = 0; i < 6; ++i) {
    const Eigen::Vector3d axis = f[i].linear().col(2);
    j.col(static_cast<Eigen::Index>(i)) << axis.cross(f[5].translation() - f[i].translation()), axis;
  }
  return j;
}

bool maybe_reachable(const Pose& base_link_T_tool0, const UrModel& model) {
  const Eigen::Vector3d p = base_link_T_tool0.translation() - model.d6 * base_link_T_tool0.linear().col(2);
  constexpr double slack = 1e-9;
  const double far = -model.a2 - model.a3 + model.d5;
  const double across_sq = p.x() * p.x() + p.y() * p.y(), height = p.z() - model.d1;
  return across_sq >= model.d4 * model.d4 - slack &&
         across_sq + height * height <= far * far + model.d4 * model.d4 + slack;
}

namespace {

// True if two solutions, with joints in (-pi, pi], are the same to within kSameSolution.
bool same_solution(const Joints& a, const Joints& b) {
  for (int j = 0; j < 6; ++j) {
    const double d = std::abs(a[j] - b[j]);
    if (d > kSameSolution && std::abs(d - kTwoPi) > kSameSolution) return false;
  }
  return true;
}

// Joint 6 (rad) at a wrist singularity or close to one, where z5, the z axis of wrist 2, may have any direction in the
// arm's plane. It is `desired`, or the nearest angle for which the links reach the wrist.
// @param desired the angle to prefer (rad)
// @param x6,y6 axes of tool0 in base_link
// @param out horizontal direction of the arm's plane
// @param u,v position (m) of the wrist's center relative to the shoulder, along `out` and upwards
double singular_q6(double desired, const Eigen::Vector3d& x6, const Eigen::Vector3d& y6, const Eigen::Vector3d& out,
                   double u, double v, const UrModel& model) {
  const Eigen::Vector3d z5 = -std::sin(desired) * x6 - std::cos(desired) * y6;
  const double w = std::hypot(u, v), bearing = std::atan2(v, u);
  if (w < 1e-12) return desired;
  // The two links must span the distance |w - d5 z5|, which grows with the angle between the wrist's bearing and z5.
  const auto angle_at = [&](double span) {
    return std::acos(std::clamp((w * w + model.d5 * model.d5 - span * span) / (2.0 * model.d5 * w), -1.0, 1.0));
  };
  const double angle = wrap(std::atan2(z5.z(), z5.dot(out)) - bearing);
  const double allowed = std::clamp(std::abs(angle), angle_at(model.a3 - model.a2), angle_at(-model.a2 - model.a3));
  if (allowed == std::abs(angle)) return desired;
  const double turned = bearing + std::copysign(allowed, angle);
  const Eigen::Vector3d z5_allowed = std::cos(turned) * out + std::sin(turned) * Eigen::Vector3d::UnitZ();
  return std::atan2(-z5_allowed.dot(x6), -z5_allowed.dot(y6));
}

constexpr double kSlack = 1e-10;  // of a cosine, for rounding errors at the border of the reach

// The planar arm of joints 2 to 4 at an angle of joint 6.
struct PlanarArm {
  double q234;  // sum of joints 2 to 4 (rad)
  double u, v;  // what the links a2 at angle q2 and a3 at angle q2 + q3 reach, along `out` and up from the shoulder (m)
  double c3;    // cosine of joint 3; beyond 1 if they do not reach it
  bool reaches() const { return std::abs(c3) <= 1.0 + kSlack; }
};

// @param q6 joint 6 (rad)
// @param x6,y6 axes of tool0 in base_link
// @param out horizontal direction of the arm's plane
// @param wrist the wrist's center in base_link (m)
PlanarArm planar_arm(double q6, const Eigen::Vector3d& x6, const Eigen::Vector3d& y6, const Eigen::Vector3d& out,
                     const Eigen::Vector3d& wrist, const UrModel& model) {
  const Eigen::Vector3d z5 = -std::sin(q6) * x6 - std::cos(q6) * y6;
  const double u = (wrist - model.d5 * z5).dot(out), v = wrist.z() - model.d5 * z5.z() - model.d1;
  return {std::atan2(z5.dot(out), -z5.z()), u, v,
          (u * u + v * v - model.a2 * model.a2 - model.a3 * model.a3) / (2.0 * model.a2 * model.a3)};
}

}  // namespace

Solutions solve(const Pose& base_link_T_tool0, double q6_desired, const UrModel& model) {
  Solutions found;
  if (!maybe_reachable(base_link_T_tool0, model)) return found;
  constexpr double kNearSingular = 1e-2;  // |sin q5| below which joint 6 may be rounded by more than kSlack allows
  constexpr double kTurned = 1e-11;       // how far (rad) the tool may be turned to make up for that
  const Eigen::Vector3d x6 = base_link_T_tool0.linear().col(0), y6 = base_link_T_tool0.linear().col(1),
                        z6 = base_link_T_tool0.linear().col(2);
  const Eigen::Vector3d wrist = base_link_T_tool0.translation() - model.d6 * z6;
  const double across = std::hypot(wrist.x(), wrist.y());
  if (model.d4 > across * (1.0 + kSlack)) return found;
  const double bearing = std::atan2(wrist.y(), wrist.x()), half = std::acos(std::min(model.d4 / across, 1.0));
  for (const double side : {1.0, -1.0}) {
    const double q1 = wrap(bearing + side * half - 0.5 * kPi);
    const double c1 = std::cos(q1), s1 = std::sin(q1);
    const Eigen::Vector3d out(-c1, -s1, 0.0), n(-s1, c1, 0.0);
    const double c5 = z6.dot(n), s5 = (z6 - c5 * n).norm();
    const bool singular = s5 < kWristSingularity;
    const auto nearest_q6 = [&](double desired) {
      return singular_q6(desired, x6, y6, out, wrist.dot(out), wrist.z() - model.d1, model);
    };
    for (const double sign5 : {1.0, -1.0}) {
      const double q5 = wrap(std::atan2(sign5 * s5, c5));
      double q6 = wrap(singular ? nearest_q6(q6_desired) : std::atan2(-sign5 * y6.dot(n), sign5 * x6.dot(n)));
      PlanarArm planar = planar_arm(q6, x6, y6, out, wrist, model);
      if (!planar.reaches() && s5 < kNearSingular) {
        // Rounding errors of joint 6 grow as 1 / s5; but when it turns, the tool turns only s5 times as far.
        const double nearer = wrap(nearest_q6(q6));
        if (!(s5 * std::abs(wrap(nearer - q6)) <= kTurned)) continue;
        q6 = nearer;
        planar = planar_arm(q6, x6, y6, out, wrist, model);
      }
      if (!planar.reaches()) continue;
      const auto [q234, u, v, c3] = planar;
      const double bend = std::acos(std::clamp(c3, -1.0, 1.0)), towards = std::atan2(v, u);
      const double lag = std::atan2(model.a3 * std::sin(bend), model.a2 + model.a3 * std::cos(bend));
      for (const double sign3 : {1.0, -1.0}) {
        const double q3 = sign3 * bend, q2 = towards - sign3 * lag;
        Joints q;
        q << q1, wrap(q2), wrap(q3), wrap(q234 - q2 - q3), q5, q6;
        if (std::none_of(found.begin(), found.end(), [&](const Joints& other) { return same_solution(q, other); }))
          found.joints[found.count++] = q;
      }
    }
  }
  return found;
}

std::vector<Joints> inverse(const Pose& base_link_T_tool0, const JointLimits& limits, double q6_desired,
                            const UrModel& model) {
  check_input(is_rigid(base_link_T_tool0), "inverse: base_link_T_tool0 is not finite or not a rigid pose");
  check_input(std::isfinite(q6_desired), "inverse: q6_desired is not finite");
  std::vector<Joints> solutions;
  for (const Joints& q : solve(base_link_T_tool0, q6_desired, model))
    if (const auto allowed = nearest(q, q, limits)) solutions.push_back(*allowed);
  return solutions;
}

}  // namespace agrisee::arm
