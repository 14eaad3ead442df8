// SPDX-License-Identifier: BSD-3-Clause
#include <agrisee/core/parameter_range.hpp>

#include <functional>
#include <limits>

#include "catch.hpp"

using namespace agrisee;

namespace {

constexpr double kInf = std::numeric_limits<double>::infinity();
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

constexpr std::array<const char*, 3> kColors{"red", "green", "blue"};

struct Inner {
  double low = 1.0, high = 2.0;
  template <typename P, typename F>
  static void fields(P& p, F&& f) {
    f("low", p.low, Range::positive());
    f("high", p.high, Range::between({p.low, "low"}, {10.0 * p.low, "10 low"}));
  }
};

struct Outer {
  std::string color = "red";
  bool flag = false;
  int count = 3;
  Inner inner;
  template <typename P, typename F>
  static void fields(P& p, F&& f) {
    f("color", p.color, OneOf(kColors));
    f("flag", p.flag);
    f("inner", p.inner);
    f("count", p.count, Range::between(1, 5));
  }
};

template <typename Change>
std::string error_of(const Change& change, const std::string& prefix = "", const std::string& separator = ".") {
  Outer outer;
  change(outer);
  try {
    check_fields(outer, prefix, separator);
  } catch (const FieldError& e) {
    CHECK(e.what() == e.key + " " + e.complaint);
    return e.what();
  }
  return "";
}

}  // namespace

TEST_CASE("a range contains the finite numbers between its ends") {
  CHECK(Range::finite().contains(-1e300));
  for (const Range& range : {Range::finite(), Range::positive(), Range::not_negative(), Range::at_least(-5.0)})
    for (const double bad : {kInf, -kInf, kNan}) CHECK_FALSE(range.contains(bad));
  CHECK_FALSE(Range::positive().contains(0.0));
  CHECK(Range::positive().contains(std::numeric_limits<double>::denorm_min()));
  CHECK(Range::not_negative().contains(0.0));
  CHECK_FALSE(Range::not_negative().contains(-1e-300));
  CHECK(Range::between(1, 3).contains(1.0));
  CHECK(Range::between(1, 3).contains(3.0));
  CHECK_FALSE(Range::between(1, 3).contains(4.0));
  CHECK_FALSE(Range::above(1.0).below(3.0).contains(1.0));
  CHECK_FALSE(Range::above(1.0).below(3.0).contains(3.0));
  CHECK(Range::above(1.0).up_to(3.0).contains(3.0));
  CHECK(Range::finite().up_to(3.0).contains(-3.0));
}

TEST_CASE("of two lower limits the stricter one counts, and NaN limits nothing") {
  CHECK_FALSE(Range::positive().from(0.0).contains(0.0));
  CHECK_FALSE(Range::positive().from(2.0).contains(1.0));
  CHECK(Range::positive().from(2.0).contains(2.0));
  CHECK(Range::positive().from(kNan).contains(1.0));
  CHECK(Range::between(kNan, kNan).contains(1.0));
}

TEST_CASE("a range says what it contains") {
  CHECK(Range::finite().text() == "finite");
  CHECK(Range::positive().text() == "positive");
  CHECK(Range::not_negative().text() == "zero or more");
  CHECK(Range::at_least(6).text() == "at least 6");
  CHECK(Range::above(0.5).text() == "above 0.5");
  CHECK(Range::between(1, 64).text() == "from 1 to 64");
  CHECK(Range::above(0.0).below({3.14159265358979, "pi"}).text() == "above 0 and below pi (3.14159265)");
  CHECK(Range::at_least(0.0).below(1.0).text() == "at least 0 and below 1");
  CHECK(Range::finite().up_to({0.12, "stand_off"}).text() == "at most stand_off (0.12)");
  CHECK(Range::positive().from({0.0, "other"}).text() == "positive");
  CHECK(OneOf(kColors).text() == "red, green or blue");
}

TEST_CASE("a value out of its range is shown as a plain number") {
  const auto message = [](const auto& value) {
    try {
      check_parameter(false, "size", "3 or more", value);
    } catch (const ParameterError& e) {
      return std::string(e.what());
    }
    return std::string();
  };
  CHECK(message(2) == "size must be 3 or more, got 2");
  CHECK(message(std::size_t(0)) == "size must be 3 or more, got 0");
  CHECK(message(-80.0) == "size must be 3 or more, got -80");
  CHECK(message(0.25f) == "size must be 3 or more, got 0.25");
  CHECK(message(1e-310) == "size must be 3 or more, got 1e-310");
  CHECK(message(kNan) == "size must be 3 or more, got nan");
  CHECK_NOTHROW(check_parameter(true, "size", "3 or more", 3));
}

TEST_CASE("a struct is checked field by field, and errors name the whole key") {
  CHECK(error_of([](Outer&) {}).empty());
  CHECK(error_of([](Outer& o) { o.count = 6; }) == "count must be from 1 to 5, got 6");
  CHECK(error_of([](Outer& o) { o.color = "pink"; }) == "color must be red, green or blue, got pink");
  CHECK(error_of([](Outer& o) { o.inner.low = -1e-9; }) == "inner.low must be positive, got -1e-09");
  CHECK(error_of([](Outer& o) { o.inner.low = 3.0; }) == "inner.high must be from low (3) to 10 low (30), got 2");
  CHECK(error_of([](Outer& o) { o.inner.high = kNan; }) == "inner.high must be a finite number, got nan");
  CHECK(error_of([](Outer& o) { o.inner.low = kNan; }) == "inner.low must be a finite number, got nan");
  CHECK(error_of([](Outer& o) { o.inner.high = 20.0; }, "top/", "/") ==
        "top/inner/high must be from low (1) to 10 low (10), got 20");
  CHECK(has_fields<Outer>);
  CHECK_FALSE(has_fields<double>);
  CHECK_FALSE(has_fields<std::string>);
}

TEST_CASE("a number that looks like millimetres or degrees is said to be so") {
  const Range length = Range::positive().up_to(1.0).in_metres(), angle = Range::between(0.0, 3.2).in_radians();
  CHECK(length.likely_cause(25.0) == ": lengths are in metres; 25 mm are 0.025");
  CHECK(angle.likely_cause(90.0) == ": angles are in radians; 90 degrees are 1.57079633");
  const Range density = Range::between(100.0, 5000.0).in_kilograms_per_cubic_metre();
  CHECK(density.likely_cause(0.98) == ": densities are in kg/m3; 0.98 g/cm3 are 980");
  CHECK(density.likely_cause(0.01).empty());  // too small in either unit
  CHECK(angle.likely_cause(-90.0).empty());
  CHECK(length.likely_cause(0.5).empty());     // in the range
  CHECK(length.likely_cause(-25.0).empty());   // too small
  CHECK(length.likely_cause(2500.0).empty());  // too large in either unit
  CHECK(length.likely_cause(kNan).empty());
  CHECK(Range::positive().up_to(1.0).likely_cause(25.0).empty());
  struct Lengths {
    double radius = 25.0;
    static void fields(const Lengths& p, const std::function<void(const char*, double, Range)>& f) {
      f("radius", p.radius, Range::positive().up_to(1.0).in_metres());
    }
  };
  CHECK_THROWS_WITH(check_fields(Lengths()),
                    "radius must be above 0 and at most 1, got 25: lengths are in metres; 25 mm are 0.025");
}

TEST_CASE("the first field out of its range is reported, in the order in which they are listed") {
  const auto both = [](Outer& o) {
    o.count = 0;
    o.inner.low = 0.0;
  };
  CHECK(error_of(both) == "inner.low must be positive, got 0");
}
