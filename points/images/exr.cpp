#include "points/images/exr.h"

#include <ImathMatrix.h>
#include <ImfChannelList.h>
#include <ImfCompression.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfIO.h>
#include <ImfOutputFile.h>
#include <ImfStandardAttributes.h>
#include <ImfStringAttribute.h>
#include <half.h>

#include <cstring>
#include <string_view>

#include "implicit/atomic_file.h"
#include "implicit/errors.h"

namespace restroke::points {
namespace {

/// The file in memory. OpenEXR writes its table of lines from a destructor, where a full disk would go
/// unnoticed; so the bytes are put together here, and AtomicFile takes care of the disk.
class MemoryStream : public OPENEXR_IMF_NAMESPACE::OStream {
 public:
  MemoryStream() : OStream("memory") {}
  void write(const char bytes[], int count) override {
    const auto size = static_cast<std::size_t>(count);
    if (position_ + size > bytes_.size()) bytes_.resize(position_ + size);
    std::memcpy(bytes_.data() + position_, bytes, size);
    position_ += size;
  }
  std::uint64_t tellp() override { return position_; }
  void seekp(std::uint64_t position) override { position_ = static_cast<std::size_t>(position); }
  [[nodiscard]] std::string_view bytes() const { return {bytes_.data(), bytes_.size()}; }

 private:
  std::vector<char> bytes_;
  std::size_t position_ = 0;
};

/// Row vectors: the columns are the camera's axes.
Imath::M44d worldToCamera(const CameraFrame& f) {
  Imath::M44d m;
  const DVec3 axes[3] = {f.right, f.up, f.forward};
  for (int column = 0; column < 3; ++column) {
    for (int row = 0; row < 3; ++row) m[row][column] = axes[column][row];
    m[3][column] = -dot(f.position, axes[column]);
  }
  return m;
}

/// From camera space: x / z = +-halfWidth is the image's edge.
Imath::M44d cameraToNdc(const CameraFrame& f, const Camera& camera) {
  const double near = static_cast<double>(camera.near), far = static_cast<double>(camera.far);
  Imath::M44d m;
  m.makeIdentity();
  m[0][0] = 0.5 / f.halfWidth;
  m[1][1] = -0.5 / f.halfHeight;
  m[2][0] = 0.5;
  m[2][1] = 0.5;
  m[2][2] = far / (far - near);
  m[2][3] = 1;
  m[3][2] = -near * far / (far - near);
  m[3][3] = 0;
  return m;
}

OPENEXR_IMF_NAMESPACE::Header headerFor(const Camera& camera, const ExrOptions& options) {
  namespace Imf = OPENEXR_IMF_NAMESPACE;
  Imf::Header header(static_cast<int>(camera.width), static_cast<int>(camera.height));
  header.compression() = Imf::ZIP_COMPRESSION;
  for (const char* name : {"R", "G", "B", "A"}) header.channels().insert(name, Imf::Channel(Imf::HALF));
  for (const char* name : {"Z", "N.X", "N.Y", "N.Z"})
    header.channels().insert(name, Imf::Channel(Imf::FLOAT));
  for (const char* name : {"id.primitive", "id.stroke"})
    header.channels().insert(name, Imf::Channel(Imf::UINT));
  const CameraFrame frame = frameOf(camera);
  const Imath::M44d toCamera = worldToCamera(frame);
  Imf::addWorldToCamera(header, Imath::M44f(toCamera));
  Imf::addWorldToNDC(header, Imath::M44f(toCamera * cameraToNdc(frame, camera)));
  for (const auto& [name, text] : options.attributes) {
    if (name.empty() || name.size() > 255)
      throw InputError(
          fmt::format("the attribute name \"{}\" has {} bytes; it must have 1 to 255", name, name.size()));
    if (header.find(name) != header.end())
      throw InputError(
          fmt::format("the attribute \"{}\" is there already; every name can be used once", name));
    header.insert(name, Imf::StringAttribute(text));
  }
  return header;
}

}  // namespace

void writeExr(const std::filesystem::path& path, const RenderedImage& image, const Camera& camera,
              const ExrOptions& options) {
  namespace Imf = OPENEXR_IMF_NAMESPACE;
  if (image.width == 0 || image.height == 0 || image.width != camera.width || image.height != camera.height)
    throw InputError(
        fmt::format("{}: the image has {} x {} pixels and its camera {} x {}; they must be equal, and not 0",
                    path.string(), image.width, image.height, camera.width, camera.height));
  AtomicFile file(path);
  MemoryStream stream;
  try {
    const Imf::Header header = headerFor(camera, options);
    std::vector<half> rgba(image.rgba.begin(), image.rgba.end());
    // OpenEXR takes pointers that it could write to; an output file only reads them.
    const auto slice = [&](Imf::PixelType type, const auto* first, std::size_t perPixel) {
      const std::size_t pixel = perPixel * sizeof(*first);
      return Imf::Slice(type, const_cast<char*>(reinterpret_cast<const char*>(first)), pixel,
                        pixel * image.width);
    };
    Imf::FrameBuffer frame;
    const char* const colors[4] = {"R", "G", "B", "A"};
    const char* const normals[3] = {"N.X", "N.Y", "N.Z"};
    for (std::size_t i = 0; i < 4; ++i) frame.insert(colors[i], slice(Imf::HALF, rgba.data() + i, 4));
    for (std::size_t i = 0; i < 3; ++i)
      frame.insert(normals[i], slice(Imf::FLOAT, image.normal.data() + i, 3));
    frame.insert("Z", slice(Imf::FLOAT, image.depth.data(), 1));
    frame.insert("id.primitive", slice(Imf::UINT, image.primitive.data(), 1));
    frame.insert("id.stroke", slice(Imf::UINT, image.stroke.data(), 1));
    Imf::OutputFile out(stream, header);
    out.setFrameBuffer(frame);
    out.writePixels(static_cast<int>(image.height));
  } catch (const std::exception& error) {
    throw InputError(fmt::format("{}: cannot write this OpenEXR file: {}", path.string(), error.what()));
  }
  file.write(stream.bytes());
  file.commit();
}

}  // namespace restroke::points
