// SPDX-License-Identifier: BSD-3-Clause
#include <agrisee/core/cancellation.hpp>
#include <agrisee/core/cloud.hpp>
#include <agrisee/core/parallel.hpp>

#include "catch.hpp"

using namespace agrisee;

TEST_CASE("cancellation: the innermost scope counts, and ends with its block") {
  CHECK_FALSE(cancellable());
  CHECK_NOTHROW(throw_if_cancelled());
  const Cancellation outer, inner;
  const Cancellation copy = outer;
  {
    const CancellationScope scope(outer);
    CHECK(cancellable());
    CHECK_NOTHROW(throw_if_cancelled());
    copy.request();
    CHECK(outer.requested());
    CHECK_THROWS_AS(throw_if_cancelled(), Cancelled);
    CHECK_THROWS_AS(throw_if_cancelled(), Error);  // of the library's family
    {
      const CancellationScope within(inner);
      CHECK_NOTHROW(throw_if_cancelled());
    }
    {
      const detail::CancellationSwap none(nullptr);
      CHECK_NOTHROW(throw_if_cancelled());
    }
    CHECK_THROWS_AS(throw_if_cancelled(), Cancelled);
  }
  CHECK_NOTHROW(throw_if_cancelled());
  {
    const CancellationScope lasting{Cancellation()};  // a scope keeps its cancellation alive
    CHECK_NOTHROW(throw_if_cancelled());
  }
}

TEST_CASE("cancellation: copying the finite points of a cloud can be cancelled") {
  const std::vector<Eigen::Vector3d> points(3, Eigen::Vector3d::Ones());
  const Cancellation stop;
  const CancellationScope scope(stop);
  CHECK(finite_points(points).size() == 3);
  stop.request();
  CHECK_THROWS_AS(finite_points(points), Cancelled);
}

TEST_CASE("cancellation: loops stop between chunks, on all threads, and only those of the scope's thread") {
  for (const int threads : {1, 3}) {
    const Cancellation stop;
    std::atomic<int> done{0};
    const auto loop = [&] {
      parallel_for(
          1000, threads,
          [&](std::size_t i) {
            ++done;
            if (i == 100) stop.request();
            if (!cancellable()) done += 100000;  // the workers have their caller's
          },
          10);
    };
    {
      const CancellationScope scope(stop);
      CHECK_THROWS_AS(loop(), Cancelled);
      CHECK(done >= 101);
      CHECK(done <= 110 + 10 * threads);
    }
    done = 0;
    CHECK_NOTHROW(parallel_for(1000, threads, [&](std::size_t) { ++done; }));
    CHECK(done == 1000);
    std::thread other([&] {
      const CancellationScope scope(stop);
      CHECK_THROWS_AS(parallel_for(1, 1, [&](std::size_t) { ++done; }), Cancelled);
    });
    other.join();
    CHECK(done == 1000);
    CHECK_FALSE(cancellable());
  }
}

TEST_CASE("cancellation: sorting stops, and sorts alike") {
  std::vector<int> values(300000);
  for (std::size_t i = 0; i < values.size(); ++i) values[i] = static_cast<int>((i * 7919) % 300007);
  std::vector<int> plain = values, watched = values;
  std::sort(plain.begin(), plain.end());
  const Cancellation stop;
  const CancellationScope scope(stop);
  detail::sort_cancellably(watched.begin(), watched.end());
  CHECK(watched == plain);
  watched = values;
  stop.request();
  CHECK_THROWS_AS(detail::sort_cancellably(watched.begin(), watched.end()), Cancelled);
  std::sort(watched.begin(), watched.end());
  CHECK(watched == plain);  // nothing was lost
}
