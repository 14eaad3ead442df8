// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Which values a parameter may take, and the check of a whole parameter struct.
///
/// A parameter struct lists its fields once, each with the range of its values:
///
/// ```
/// template <typename P, typename F>
/// static void fields(P& p, F&& f) {
///   f("enabled", p.enabled);                                                // true or false: no range
///   f("radius_min", p.radius_min, Range::positive().up_to(1.0).in_metres());  // a number
///   f("radius_max", p.radius_max, Range::at_least({p.radius_min, "radius_min"}));
///   f("planner", p.planner, OneOf(kPlannerNames));                          // a text
///   f("fit", p.fit);                                                        // a struct with fields of its own
/// }
/// ```
/// check_fields() checks them all. An error names the whole key as a file has it: `split.bodies.fit.noise`. Functions
/// that do something else with every field take the range as a last, optional argument and ignore it.
#pragma once

#include <agrisee/core/error.hpp>

#include <array>
#include <cmath>
#include <limits>
#include <string>
#include <type_traits>
#include <utility>

namespace agrisee {

/// One field of a parameter struct has a value that it may not have; `what()` is "<key> <complaint>".
struct FieldError : ParameterError {
  /// @param whole_key  the key as a file has it
  /// @param what_is_wrong "must be ..., got ..."
  FieldError(const std::string& whole_key, const std::string& what_is_wrong)
      : ParameterError(whole_key + " " + what_is_wrong), key(whole_key), complaint(what_is_wrong) {}

  std::string key;        ///< whole key of the field, e.g. `gain.expected.voxel`
  std::string complaint;  ///< "must be ..., got ..."
};

/// An end of a range: a number and, where it is computed from something, the name that messages use for it.
struct Limit {
  /// Implicit, so that a plain number is a limit.
  constexpr Limit(double number, const char* name_of_it = nullptr) : value(number), name(name_of_it) {}

  double value;      ///< the number; NaN limits nothing
  const char* name;  ///< such as "radius_min" or "pi"; null: the number speaks for itself
};

/// The values that a number may take: an interval of finite numbers.
class Range {
 public:
  /// Any finite number.
  static constexpr Range finite() { return Range(); }
  /// Above zero.
  static constexpr Range positive() { return above(0.0); }
  /// Zero or more.
  static constexpr Range not_negative() { return at_least(0.0); }
  /// The limit or more.
  static constexpr Range at_least(Limit low) { return Range().from(low); }
  /// More than the limit.
  static constexpr Range above(Limit low) {
    Range range;
    range.low_ = low;
    range.low_open_ = true;
    return range;
  }
  /// From one limit to the other, both included.
  static constexpr Range between(Limit low, Limit high) { return at_least(low).up_to(high); }

  /// This range without the numbers below a limit. A stricter lower limit stays.
  constexpr Range from(Limit low) const {
    Range range = *this;
    if (low.value > low_.value) {
      range.low_ = low;
      range.low_open_ = false;
    }
    return range;
  }
  /// This range with the largest number `high`.
  constexpr Range up_to(Limit high) const {
    Range range = *this;
    range.high_ = high;
    return range;
  }
  /// This range, up to but not including `high`.
  constexpr Range below(Limit high) const {
    Range range = up_to(high);
    range.high_open_ = true;
    return range;
  }

  /// This range for a length in metres: messages point out a number that would be valid in millimetres.
  constexpr Range in_metres() const { return with_unit("lengths are in metres; ", "mm", 1e-3); }
  /// This range for a density in kg/m3: messages point out a number that would be valid in g/cm3.
  constexpr Range in_kilograms_per_cubic_metre() const {
    return with_unit("densities are in kg/m3; ", "g/cm3", 1000.0);
  }
  /// This range for an angle in radians: messages point out a number that would be valid in degrees.
  constexpr Range in_radians() const { return with_unit("angles are in radians; ", "degrees", 0.017453292519943295); }

  /// Whether a number is in the range. NaN and infinity never are.
  bool contains(double x) const {
    if (!std::isfinite(x)) return false;
    const bool too_low = low_open_ ? x <= low_.value : x < low_.value;
    const bool too_high = high_open_ ? x >= high_.value : x > high_.value;
    return !too_low && !too_high;
  }

  /// What a number in the range is: "positive", "from 1 to 64", "above 0 and below pi (3.14159265)".
  std::string text() const {
    const bool has_low = low_.value > -kInfinity, has_high = high_.value < kInfinity;
    if (!has_low && !has_high) return "finite";
    if (has_low && has_high && !low_open_ && !high_open_) return "from " + words(low_) + " to " + words(high_);
    const std::string high = (high_open_ ? "below " : "at most ") + words(high_);
    if (!has_low) return high;
    if (!has_high && low_.value == 0.0 && !low_.name) return low_open_ ? "positive" : "zero or more";
    const std::string low = (low_open_ ? "above " : "at least ") + words(low_);
    return has_high ? low + " and " + high : low;
  }

  /// The likely cause of a number outside the range, to be put behind a message: ": lengths are in metres; 25 mm are
  /// 0.025". Empty where none is known.
  std::string likely_cause(double x) const {
    if (!unit_rule_ || contains(x) || !contains(other_unit_ * x)) return "";
    return std::string(": ") + unit_rule_ + number(x) + " " + other_name_ + " are " + number(other_unit_ * x);
  }

  /// A number as messages show it.
  static std::string number(double x) { return number_text(x, 9); }

 private:
  static constexpr double kInfinity = std::numeric_limits<double>::infinity();

  constexpr Range() = default;

  constexpr Range with_unit(const char* rule, const char* other, double factor) const {
    Range range = *this;
    range.unit_rule_ = rule;
    range.other_name_ = other;
    range.other_unit_ = factor;
    return range;
  }

  static std::string words(const Limit& limit) {
    return limit.name ? std::string(limit.name) + " (" + number(limit.value) + ")" : number(limit.value);
  }

  Limit low_ = -kInfinity, high_ = kInfinity;
  bool low_open_ = false, high_open_ = false;  // whether the limit itself is outside
  const char* unit_rule_ = nullptr;            // null: the field has no unit that is often mistaken
  const char* other_name_ = nullptr;           // of the unit in which the field may have been given by mistake
  double other_unit_ = 0.0;                    // in units of the field
};

/// The texts that a parameter may take. Refers to the array that it was made from.
class OneOf {
 public:
  /// @param names the texts; they have to outlive this object
  template <std::size_t N>
  explicit constexpr OneOf(const std::array<const char*, N>& names) : names_(names.data()), count_(N) {}

  /// Whether a text is one of them.
  bool contains(const std::string& text) const {
    for (std::size_t i = 0; i < count_; ++i)
      if (text == names_[i]) return true;
    return false;
  }

  /// All of them: "gain, see, fixed or random".
  std::string text() const {
    std::string out;
    for (std::size_t i = 0; i < count_; ++i) {
      if (i > 0) out += i + 1 < count_ ? ", " : " or ";
      out += names_[i];
    }
    return out;
  }

 private:
  const char* const* names_;
  std::size_t count_;
};

namespace detail {

/// Stands for any function that is called with the fields of a struct. Never called.
struct AnyFieldVisitor {
  template <typename... Arguments>
  void operator()(const Arguments&...) const;
};

template <typename T, typename = void>
struct HasFields : std::false_type {};
template <typename T>
struct HasFields<T, std::void_t<decltype(T::fields(std::declval<const T&>(), std::declval<AnyFieldVisitor>()))>>
    : std::true_type {};

/// Throw FieldError unless a field's value keeps to its rule, a Range or OneOf.
template <typename T, typename Rule>
void check_field(const std::string& prefix, const char* name, const T& value, const Rule& rule) {
  if constexpr (std::is_arithmetic_v<T>) {
    const auto x = static_cast<double>(value);
    if (rule.contains(x)) return;
    const std::string wanted = std::isfinite(x) ? rule.text() : "a finite number";
    throw FieldError(prefix + name, "must be " + wanted + ", got " + Range::number(x) + rule.likely_cause(x));
  } else {
    if (!rule.contains(value)) throw FieldError(prefix + name, "must be " + rule.text() + ", got " + value);
  }
}

}  // namespace detail

/// Whether T is a struct that lists its fields.
template <typename T>
constexpr bool has_fields = detail::HasFields<T>::value;

/// Check every field of a parameter struct, and of the structs within it, in the order in which they are listed.
/// @param parameters a struct with `fields`
/// @param prefix     what stands before the names in messages, e.g. "split.bodies."
/// @param separator  between the name of a struct and those of its fields
/// @throws FieldError for the first field that is out of its range
template <typename P>
void check_fields(const P& parameters, const std::string& prefix = "", const std::string& separator = ".") {
  P::fields(parameters, [&](const char* name, const auto& value, const auto&... rule) {
    using T = std::decay_t<decltype(value)>;
    static_assert(sizeof...(rule) <= 1, "a field has at most one rule");
    static_assert(!std::is_floating_point_v<T> || sizeof...(rule) == 1, "a number needs a range");
    if constexpr (has_fields<T>)
      check_fields(value, prefix + name + separator, separator);
    else
      (detail::check_field(prefix, name, value, rule), ...);
  });
}

}  // namespace agrisee
