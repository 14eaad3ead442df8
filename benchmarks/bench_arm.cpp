// SPDX-License-Identifier: BSD-3-Clause
// The UR3's kinematics, collisions and reach in the default cell, one thread.
#include <agrisee/arm/reachability.hpp>
#include <agrisee/core/random.hpp>

#include <benchmark/benchmark.h>

using namespace agrisee;
using namespace agrisee::arm;

namespace {

const Eigen::Vector3d kTruss(0.015, 0.545, 0.21);
const Joints kStart = (Joints() << 0.0, -1.57, 1.57, -1.57, -1.57, 0.0).finished();

Mount cell() {
  Mount mount;
  mount.keep_out = {{"platform", Box{{0, -0.1, -0.06}, {0.7, 0.7, 0.1}}},
                    {"plant", Box{{0, 0.85, 0.3}, {1.2, 0.5, 1.6}}},
                    {"cluster", Cylinder{kTruss, 0.35, 0.9}}};
  return mount;
}

/// 4096 random postures; with `free_only` those that collide with nothing in the cell.
std::vector<Joints> postures(bool free_only) {
  const Mount mount = cell();
  Rng rng(1);
  std::vector<Joints> out;
  while (out.size() < 4096) {
    Joints q;
    for (int j = 0; j < 6; ++j) q[j] = rng.uniform(-kPi, kPi);
    if (!free_only || !collides(q, mount)) out.push_back(q);
  }
  return out;
}

/// Runs f(posture) over the postures in turn.
template <typename F>
void over_postures(benchmark::State& state, bool free_only, F&& f) {
  const auto qs = postures(free_only);
  std::size_t i = 0;
  for (auto _ : state) benchmark::DoNotOptimize(f(qs[i++ & 4095]));
}

void forward_kinematics(benchmark::State& state) {
  over_postures(state, false, [](const Joints& q) { return forward(q); });
}

void jacobians(benchmark::State& state) {
  over_postures(state, false, [](const Joints& q) { return jacobian(q); });
}

void inverse_kinematics(benchmark::State& state) {
  std::vector<Pose> poses;
  for (const Joints& q : postures(false)) poses.push_back(forward(q));
  std::size_t i = 0;
  for (auto _ : state) benchmark::DoNotOptimize(inverse(poses[i++ & 4095]));
}

void collision_random(benchmark::State& state) {
  const Mount mount = cell();
  over_postures(state, false, [&](const Joints& q) { return collides(q, mount); });
}

void collision_free(benchmark::State& state) {
  const Mount mount = cell();
  over_postures(state, true, [&](const Joints& q) { return collides(q, mount); });
}

/// Views of the truss from all around: those that the arm can take, or those that it cannot.
void reach_views(benchmark::State& state) {
  const bool reachable = state.range(0) != 0;
  const Mount mount = cell();
  std::vector<Eigen::Vector3d> views;
  for (int az = -90; az <= 90; az += 5)
    for (int el = -40; el <= 60; el += 5) {
      const Eigen::Vector3d d(-std::sin(deg(az)) * std::cos(deg(el)), std::cos(deg(az)) * std::cos(deg(el)),
                              -std::sin(deg(el)));
      if (reach(mount, kStart, kTruss, d).has_value() == reachable) views.push_back(d);
    }
  std::size_t i = 0;
  for (auto _ : state) benchmark::DoNotOptimize(reach(mount, kStart, kTruss, views[i++ % views.size()]));
  state.counters["views"] = static_cast<double>(views.size());
}

}  // namespace

BENCHMARK(forward_kinematics);
BENCHMARK(jacobians);
BENCHMARK(inverse_kinematics);
BENCHMARK(collision_random);
BENCHMARK(collision_free);
BENCHMARK(reach_views)->ArgName("reachable")->Arg(1)->Arg(0)->Unit(benchmark::kMicrosecond);
