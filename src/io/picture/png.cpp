// SPDX-License-Identifier: BSD-3-Clause
#include <agrisee/io/files.hpp>
#include <agrisee/io/png.hpp>

#define STB_IMAGE_WRITE_IMPLEMENTATION
#define STB_IMAGE_WRITE_STATIC
#define STBI_WRITE_NO_STDIO
#include <new>
#include <stb_image_write.h>

#include "io/picture/gray_png.hpp"

namespace agrisee::io {
namespace {

/// Of a picture with smooth surfaces, the filter "sub" and quick compression give a file that is hardly larger than the
/// best of all filters, in a third of the time.
[[maybe_unused]] const bool configured = [] {
  stbi_write_force_png_filter = 1;
  stbi_write_png_compression_level = 5;
  return true;
}();

}  // namespace

void write_png(const std::filesystem::path& path, const Image& image) {
  check_input(image.width > 0 && image.height > 0 &&
                  image.pixels.size() == static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.height),
              "write_png: the image is empty or its size and pixels disagree");
  static_assert(sizeof(Rgb) == 3, "pixels are packed");
  AtomicFile file(path);
  struct Target {
    AtomicFile& file;
    std::exception_ptr error;  // an exception must not pass through the C code of stb
  } target{file, nullptr};
  const auto write = [](void* context, void* data, int size) {
    auto& to = *static_cast<Target*>(context);
    try {
      if (!to.error) to.file.write(data, static_cast<std::size_t>(size));
    } catch (...) {
      to.error = std::current_exception();
    }
  };
  const int done = stbi_write_png_to_func(write, &target, image.width, image.height, 3, image.pixels.data(), 0);
  if (target.error) std::rethrow_exception(target.error);
  if (!done) fail(path, "cannot be written: out of memory");
  file.commit();
}

std::string gray_png(int width, int height, const std::vector<std::uint8_t>& levels) {
  int size = 0;
  unsigned char* const bytes = stbi_write_png_to_mem(levels.data(), 0, width, height, 1, &size);
  if (!bytes) throw std::bad_alloc();
  std::string out(reinterpret_cast<const char*>(bytes), static_cast<std::size_t>(size));
  STBIW_FREE(bytes);
  return out;
}

}  // namespace agrisee::io
