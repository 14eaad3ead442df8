// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// A perspective view in a part of the canvas: draws surface elements with a depth buffer, and lines in space.
#pragma once

#include <agrisee/core/cloud.hpp>

#include "io/picture/canvas.hpp"

namespace agrisee::io {

/// A part of the canvas, in fine pixels.
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
  float width = 2.0f;   ///< fine pixels
  float alpha = 1.0f;   ///< opacity where the line is visible
  float hidden = 0.0f;  ///< opacity where the line is hidden
};

/// A perspective view. World frame, metres.
class Panel {
 public:
  /// Look along `direction`, with `up` upwards in the viewport. The eye is placed as near as possible such that all
  /// `subjects` are in the viewport, centred.
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
  /// Fine pixels per metre at that depth (m).
  float scale(float depth) const { return focal_ / depth; }
  const Eigen::Vector3d& eye() const { return eye_; }
  /// Unit axes of the view: right, down, forward.
  Eigen::Vector3d axis(int i) const { return rotation_.row(i).transpose(); }
  const Viewport& viewport() const { return viewport_; }

 private:
  struct Pixel {
    Color color = Color::Zero();
    Eigen::Vector3f normal = Eigen::Vector3f::Zero();
    float weight = 0.0f;
    bool backed = false;  ///< another surface is behind the foremost
  };
  template <typename Visit>
  void rasterise(const Splats& splats, Visit&& visit) const;
  float openness(int i, int j, float deep) const;
  void shade(const std::vector<Pixel>& pixels, float deep);
  /// Index of the cell in column i and row j.
  std::size_t cell(int i, int j) const {
    return static_cast<std::size_t>(j) * static_cast<std::size_t>(columns_) + static_cast<std::size_t>(i);
  }
  /// Depth of the cell that holds a pixel of the canvas.
  float depth(int x, int y) const {
    return depth_[cell((x - viewport_.x) / Canvas::kScale, (y - viewport_.y) / Canvas::kScale)];
  }
  bool inside(int x, int y) const {
    return x >= viewport_.x && y >= viewport_.y && x < viewport_.x + viewport_.width &&
           y < viewport_.y + viewport_.height;
  }

  Canvas& canvas_;
  Viewport viewport_;
  Eigen::Vector3d eye_ = Eigen::Vector3d::Zero();
  Eigen::Matrix3d rotation_ = Eigen::Matrix3d::Identity();  // rows: right, down, forward
  float focal_ = 1.0f, cx_ = 0.0f, cy_ = 0.0f;
  // Discs are drawn in cells of kScale x kScale fine pixels, a pixel of the image each; lines and texts finer.
  int columns_ = 0, rows_ = 0;
  std::vector<float> depth_;  // depth of each cell (m); infinite where nothing is drawn
};

}  // namespace agrisee::io
