// SPDX-License-Identifier: BSD-3-Clause
#include "report/markdown.hpp"

#include <algorithm>
#include <cmath>
#include <map>

namespace agrisee::report {
namespace {

/// Reasons with their counts; the count of a single reason is omitted.
std::string counted(const std::map<std::string, std::size_t>& reasons) {
  std::string out;
  for (const auto& [reason, count] : reasons) {
    if (!out.empty()) out += ", ";
    out += text(reason.empty() ? "-" : reason);
    if (reasons.size() > 1) out += " " + std::to_string(count);
  }
  return out;
}

}  // namespace

std::string fixed(const std::optional<double>& value, int digits) {
  if (!value || !std::isfinite(*value) || std::abs(*value) > 1e15) return "-";
  long long unit = 1;
  for (int i = 0; i < digits; ++i) unit *= 10;
  const long long n = std::llround(std::abs(*value) * static_cast<double>(unit));
  std::string digits_text = std::to_string(n % unit);
  std::string out = *value < 0.0 && n > 0 ? "-" : "";
  out += std::to_string(n / unit);
  if (digits == 0) return out;
  digits_text.insert(0, static_cast<std::size_t>(digits) - digits_text.size(), '0');
  return out + "." + digits_text;
}

std::string text(const std::string& name) {
  const auto is_word = [&](std::size_t i) {
    if (i >= name.size()) return false;
    const auto c = static_cast<unsigned char>(name[i]);
    return (c >= '0' && c <= '9') || ((c | 32) >= 'a' && (c | 32) <= 'z');
  };
  std::string out;
  for (std::size_t i = 0; i < name.size(); ++i) {
    const char c = name[i];
    switch (c) {
      case '<':
        out += "&lt;";
        break;
      case '>':
        out += "&gt;";
        break;
      case '&':
        out += "&amp;";
        break;
      case '|':
      case '\\':
      case '`':
      case '*':
      case '[':
      case ']':
      case '#':
      case '~':
      case '$':
        out += '\\', out += c;
        break;
      case '_':
        if (i == 0 || !is_word(i - 1) || !is_word(i + 1)) out += '\\';
        out += c;
        break;
      default:
        out += static_cast<unsigned char>(c) < 32 ? ' ' : c;
    }
  }
  return out;
}

std::string shown(const Mean& mean, int digits, const std::optional<double>& paper) {
  std::string out = fixed(mean.value, digits);
  if (mean.value && mean.have < mean.of) out += " [" + std::to_string(mean.have) + "/" + std::to_string(mean.of) + "]";
  if (paper) out += " (" + fixed(paper, digits) + ")";
  return out;
}

std::string pair(const std::optional<double>& mean, const std::optional<double>& worst, int digits) {
  if (!mean && !worst) return "-";
  return fixed(mean, digits) + " / " + fixed(worst, digits);
}

std::string Table::markdown() const {
  const auto width = [](const std::string& s) {  // number of characters in UTF-8
    std::size_t n = 0;
    for (const char c : s) n += (static_cast<unsigned char>(c) & 0xC0) != 0x80;
    return n;
  };
  std::vector<std::size_t> widths;
  for (std::size_t i = 0; i < head_.size(); ++i) {
    std::size_t widest = std::max<std::size_t>(3, width(head_[i]));
    for (const auto& row : rows_) widest = std::max(widest, width(row.at(i)));
    widths.push_back(widest);
  }
  std::string out;
  const auto line = [&](const std::vector<std::string>& cells) {
    for (std::size_t i = 0; i < widths.size(); ++i) {
      const std::string pad(widths[i] - width(cells[i]), ' ');
      out += "| " + (i == 0 ? cells[i] + pad : pad + cells[i]) + ' ';
    }
    out += "|\n";
  };
  line(head_);
  for (std::size_t i = 0; i < widths.size(); ++i)
    out += "| " + (i == 0 ? std::string(widths[i], '-') : std::string(widths[i] - 1, '-') + ":") + ' ';
  out += "|\n";
  for (const auto& row : rows_) line(row);
  return out;
}

std::string mean_and_worst(const Group& group, const Figure& figure) {
  return pair(mean(group, figure).value, worst_row(group, figure), figure.digits);
}

std::string stop_reasons(const Row& row) {
  std::map<std::string, std::size_t> reasons;
  for (const CellRecord* cell : row.trials) ++reasons[cell->stop_reason];
  return counted(reasons);
}

std::string stop_reasons(const Group& group) {
  std::map<std::string, std::size_t> reasons;
  for (const Row& row : group.rows)
    for (const CellRecord* cell : row.trials) ++reasons[cell->stop_reason];
  return counted(reasons);
}

std::string picture(const Data& data, const std::string& file, const std::string& caption) {
  return "![" + text(caption) + "](" + data.folder + "/" + file + ")\n\n";
}

}  // namespace agrisee::report
