// SPDX-License-Identifier: BSD-3-Clause
#include <agrisee/io/cloud_file.hpp>
#include <agrisee/io/files.hpp>
#include <agrisee/io/pcd.hpp>
#include <agrisee/io/ply.hpp>

#include "io/formats/cloud_columns.hpp"
#include "io/formats/mcap.hpp"
#include "io/formats/npy.hpp"
#include "io/formats/table.hpp"
#include "io/formats/text.hpp"

namespace agrisee::io {

CloudFile read_cloud(const std::filesystem::path& path, NonFinite non_finite) {
  InputFile file(path);
  std::string first(4096, '\0');
  first.resize(file.read(first.data(), first.size()));
  const std::string extension = lower(path.extension().string());
  if (first.compare(0, 3, "ply") == 0 && (first.size() < 4 || is_blank(first[3]))) return read_ply(path, non_finite);
  if (first.compare(0, 6, "# .PCD") == 0 || first.compare(0, 7, "VERSION") == 0 || extension == ".pcd")
    return read_pcd(path, non_finite);
  if (extension == ".ply") return read_ply(path, non_finite);
  if (is_npy(first) || extension == ".npy") return read_npy_cloud(path, non_finite);
  if (first.empty()) fail(path, "is empty");
  if (is_table(first) || extension == ".xyz" || extension == ".csv") return read_table_cloud(path, non_finite);
  if (const std::string recording = mcap::other_recording(first); !recording.empty()) fail(path, recording);
  fail(path, "is no point cloud that can be read: neither PLY, PCD or NPY nor a table of numbers (XYZ, CSV)");
}

CloudFile read_npy_cloud(const std::filesystem::path& path, NonFinite non_finite) {
  const Bytes bytes = read_bytes(path);
  const NpyArray array = parse_npy(path, bytes.view());
  const std::vector<std::size_t>& shape = array.shape;
  const bool organized = shape.size() == 3;
  if ((shape.size() != 2 && !organized) || shape.back() < 3)
    fail(path, "has the shape " + array.shape_text() + "; a cloud has the shape (points, 3)");
  if (shape[0] == 3 && shape.back() > 16)
    fail(path, "has the shape " + array.shape_text() +
                   ", but x, y and z are its last axis: save it with numpy.moveaxis(a, 0, -1)");
  if (array.fortran && organized) fail(path, "is stored column by column; save it with numpy.ascontiguousarray");
  const std::size_t points = organized ? shape[0] * shape[1] : shape[0], size = size_of(array.type);
  CloudColumns cloud(path, points, {"x", "y", "z"});
  std::vector<Column> columns;
  for (std::size_t axis = 0; axis < 3; ++axis)
    columns.push_back({array.data + axis * size * (array.fortran ? points : 1),
                       size * (array.fortran ? 1 : shape.back()), array.type, array.swapped,
                       cloud.sink(std::string(1, "xyz"[axis]))});
  decode(columns, points);
  CloudFile out = cloud.finish(non_finite, organized ? shape[1] : points, organized ? shape[0] : 1);
  out.skipped = shape.back() - 3;
  return out;
}

}  // namespace agrisee::io
