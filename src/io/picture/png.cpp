// SPDX-License-Identifier: BSD-3-Clause
#include <agrisee/io/files.hpp>
#include <agrisee/io/png.hpp>

#define STB_IMAGE_WRITE_IMPLEMENTATION
#define STB_IMAGE_WRITE_STATIC
#define STBI_WRITE_NO_STDIO
#include <stb_image_write.h>

namespace agrisee::io {

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

}  // namespace agrisee::io
