// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// A perspective view in a part of the canvas: draws surface elements with a depth buffer, and lines in space.
#pragma once

#include <agrisee/core/cloud.hpp>

#include <limits>

#include "io/picture/canvas.hpp"

namespace agrisee::io {

/// A part of the canvas (pixels).
struct Viewport {
  int x = 0, y = 0, width = 0, height = 0;
};

/// The points of a cloud, drawn as discs on its surface (splats).
struct Splats {
  const Cloud& cloud;
  std::vector<Color> colors;  ///< one per point
  float radius = 0.002f;      ///< radius of the discs (m)
};

/// How a line is drawn where it is visible, and where something is in front of it.
struct LineStyle {
  float width = 1.0f;   ///< pixels
  float alpha = 1.0f;   ///< opacity where the line is visible
  float hidden = 0.0f;  ///< opacity where the line is hidden
};

/// A perspective view. World frame, metres.
class Panel {
 public:
  /// Look along `direction`, with `up` upwards in the viewport. The eye is placed as near as possible such that all
  /// `subjects` are in the viewport, centered.
  Panel(Canvas& canvas, const Viewport& viewport, const Eigen::Vector3d& direction, const Eigen::Vector3d& up,
        const std::vector<Eigen::Vector3d>& subjects);

  /// Draw the discs, shaded. Lines that are drawn later are hidden behind them.
  void draw(const Splats& splats);
  void line(const Eigen::Vector3d& a, const Eigen::Vector3d& b, const Color& c, const LineStyle& style,
            Cap cap = Cap::butt);
  void polyline(const std::vector<Eigen::Vector3d>& points, const Color& c, const LineStyle& style);

  /// Pixel of a point on the canvas; z is its depth (m), small or negative if it is behind the eye.
  Eigen::Vector3f project(const Eigen::Vector3d& p) const;
  Eigen::Vector2f pixel(const Eigen::Vector3d& p) const { return project(p).head<2>(); }
  /// Pixels per metre at that depth (m).
  float scale(float depth) const { return focal_ / depth; }
  const Eigen::Vector3d& eye() const { return eye_; }
  /// Unit axes of the view: right, down, forward.
  Eigen::Vector3d axis(int i) const { return rotation_.row(i).transpose(); }
  const Viewport& viewport() const { return viewport_; }

 private:
  /// What the discs at a pixel add up to, in fours, which processors add at once.
  struct Pixel {
    Eigen::Array4f color = Eigen::Array4f::Zero();   ///< times the weights; then the sum of the weights
    Eigen::Array4f normal = Eigen::Array4f::Zero();  ///< times the weights; then 1 if another surface is behind
    float weight() const { return color[3]; }
    bool is_backed() const { return normal[3] > 0.0f; }
  };
  static constexpr float kSmallest = 1.0f, kLargest = 40.0f;  // bounds of a disc's radius (pixels)
  /// A row of pixels across a disc.
  struct Row {
    float depth[2 * int(kLargest) + 4];  ///< of the disc's plane (m)
    float share[2 * int(kLargest) + 4];  ///< squared distance from its center, over its squared radius
    int size = 0;
  };
  /// The part of the viewport on which discs are drawn.
  struct Extent {
    int left = std::numeric_limits<int>::max(), top = left, right = 0, bottom = 0;
    void extend(int i, int j, int width) {
      left = std::min(left, i), right = std::max(right, i + width);
      top = std::min(top, j), bottom = std::max(bottom, j + 1);
    }
    std::size_t size() const { return right > 0 ? at(right - 1, bottom - 1) + 1 : 0; }
    std::size_t at(int i, int j) const {
      return static_cast<std::size_t>(j - top) * static_cast<std::size_t>(right - left) +
             static_cast<std::size_t>(i - left);
    }
  };
  template <typename Visit>
  void rasterise(const Splats& splats, Visit&& visit) const;
  void openness(int j, int begin, int end, float deep, std::vector<float>& out) const;
  void shade(const std::vector<Pixel>& pixels, const Extent& drawn, float deep);
  /// Index of the pixel in column i and row j of the viewport.
  std::size_t cell(int i, int j) const {
    return static_cast<std::size_t>(j) * static_cast<std::size_t>(viewport_.width) + static_cast<std::size_t>(i);
  }
  /// Depth at a pixel of the canvas.
  float depth(int x, int y) const { return depth_[cell(x - viewport_.x, y - viewport_.y)]; }
  bool inside(int x, int y) const {
    return x >= viewport_.x && y >= viewport_.y && x < viewport_.x + viewport_.width &&
           y < viewport_.y + viewport_.height;
  }

  Canvas& canvas_;
  Viewport viewport_;
  Eigen::Vector3d eye_ = Eigen::Vector3d::Zero();
  Eigen::Matrix3d rotation_ = Eigen::Matrix3d::Identity();  // rows: right, down, forward
  float focal_ = 1.0f, cx_ = 0.0f, cy_ = 0.0f;
  std::vector<float> depth_;  // of each pixel of the viewport (m); infinite where nothing is drawn
};

}  // namespace agrisee::io
