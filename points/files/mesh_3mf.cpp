// 3MF: 3D Manufacturing Format, Core Specification, https://github.com/3MFConsortium/spec_core. Read by
// lib3mf. Written by ourselves: lib3mf 1.8 rounds coordinates to six decimals and adds random identifiers, so
// that the same shape would never be the same file.

#include <Model/COM/NMR_DLLInterfaces.h>

#include <array>
#include <cmath>
#include <iterator>
#include <utility>
#include <vector>

#include "points/files/mesh_formats.h"
#include "points/files/zip.h"

namespace restroke::points::formats {
namespace {

/// What lib3mf takes.
constexpr float kLargestCoordinate = 1e9f;

/// Whatever lib3mf makes: its types are all the same.
using Object = NMR::PLib3MFBase*;

/// Gives an object back.
class Handle {
 public:
  Handle() = default;
  ~Handle() {
    if (object_ != nullptr) NMR::lib3mf_release(object_);
  }
  Handle(const Handle&) = delete;
  Handle& operator=(const Handle&) = delete;
  [[nodiscard]] Object get() const { return object_; }
  /// For calls that make an object.
  [[nodiscard]] Object* out() { return &object_; }

 private:
  Object object_ = nullptr;
};

/// Rows of a 4 x 4 matrix that end with 0 0 0 1: p becomes p R + t.
struct Placement {
  std::array<DVec3, 3> rows{DVec3(1, 0, 0), DVec3(0, 1, 0), DVec3(0, 0, 1)};
  DVec3 move{0};

  [[nodiscard]] DVec3 turned(DVec3 p) const { return p.x * rows[0] + p.y * rows[1] + p.z * rows[2]; }
  [[nodiscard]] DVec3 operator()(DVec3 p) const { return turned(p) + move; }
  /// `inner` first, then this one.
  [[nodiscard]] Placement after(const Placement& inner) const {
    Placement both;
    for (std::size_t i = 0; i < 3; ++i) both.rows[i] = turned(inner.rows[i]);
    both.move = (*this)(inner.move);
    return both;
  }
  [[nodiscard]] double determinant() const { return dot(rows[0], cross(rows[1], rows[2])); }
};

Placement placementOf(const NMR::MODELTRANSFORM& t) {
  // m_fFields[column][row]; row 3 moves.
  Placement p;
  for (int column = 0; column < 3; ++column) {
    for (int row = 0; row < 3; ++row)
      p.rows[static_cast<std::size_t>(row)][column] = static_cast<double>(t.m_fFields[column][row]);
    p.move[column] = static_cast<double>(t.m_fFields[column][3]);
  }
  return p;
}

class Reader3mf {
 public:
  explicit Reader3mf(const Source& source) : source_(source) {}

  TriangleMesh read() {
    check(NMR::lib3mf_createmodel(model_.out()), nullptr);
    Handle reader;
    check(NMR::lib3mf_model_queryreader(model_.get(), MODELREADERCLASS_3MF, reader.out()), model_.get());
    // lib3mf only reads what it takes as bytes to write.
    auto* const bytes = reinterpret_cast<BYTE*>(const_cast<char*>(source_.bytes.data()));
    check(NMR::lib3mf_reader_readfrombuffer(reader.get(), bytes, source_.bytes.size()), reader.get());
    checkWarnings(reader.get());
    if (!readBuild()) readAllMeshes();
    return std::move(mesh_).finish();
  }

 private:
  void check(LIB3MFRESULT result, Object object) const {
    if (result == 0) return;
    DWORD code = 0;
    const char* message = nullptr;
    if (object != nullptr) NMR::lib3mf_getlasterror(object, &code, &message);
    refuse(source_, "",
           fmt::format("lib3mf cannot read the 3MF model: {}",
                       message != nullptr && *message != 0 ? lowered(message) : "no reason given"));
  }

  /// lib3mf passes over some faults. Those that do not touch the shape are no concern of ours.
  void checkWarnings(Object reader) const {
    constexpr DWORD kUnknownMetadata = 32946, kMissingDefaultProperty = 32955;
    DWORD count = 0;
    check(NMR::lib3mf_reader_getwarningcount(reader, &count), reader);
    for (DWORD i = 0; i < count; ++i) {
      DWORD code = 0;
      std::array<char, 300> text{};
      ULONG needed = 0;
      check(NMR::lib3mf_reader_getwarningutf8(reader, i, &code, text.data(), text.size() - 1, &needed),
            reader);
      if (code != kUnknownMetadata && code != kMissingDefaultProperty)
        refuse(source_, "", fmt::format("lib3mf finds the 3MF model at fault: {}", lowered(text.data())));
    }
  }

  /// False when nothing is to be built.
  bool readBuild() {
    Handle items;
    check(NMR::lib3mf_model_getbuilditems(model_.get(), items.out()), model_.get());
    bool any = false;
    for (;;) {
      BOOL has = 0;
      check(NMR::lib3mf_builditemiterator_movenext(items.get(), &has), items.get());
      if (!has) return any;
      any = true;
      Handle item, object;
      check(NMR::lib3mf_builditemiterator_getcurrent(items.get(), item.out()), items.get());
      Placement placement;
      BOOL hasTransform = 0;
      check(NMR::lib3mf_builditem_hasobjecttransform(item.get(), &hasTransform), item.get());
      if (hasTransform) {
        NMR::MODELTRANSFORM transform{};
        check(NMR::lib3mf_builditem_getobjecttransform(item.get(), &transform), item.get());
        placement = placementOf(transform);
      }
      check(NMR::lib3mf_builditem_getobjectresource(item.get(), object.out()), item.get());
      readObject(object.get(), placement, 0);
    }
  }

  void readAllMeshes() {
    Handle meshes;
    check(NMR::lib3mf_model_getmeshobjects(model_.get(), meshes.out()), model_.get());
    for (;;) {
      BOOL has = 0;
      check(NMR::lib3mf_resourceiterator_movenext(meshes.get(), &has), meshes.get());
      if (!has) return;
      Handle object;
      check(NMR::lib3mf_resourceiterator_getcurrent(meshes.get(), object.out()), meshes.get());
      readObject(object.get(), {}, 0);
    }
  }

  void readObject(Object object, const Placement& placement, int depth) {
    constexpr int kDeepest = 32;
    if (depth > kDeepest)
      refuse(source_, "",
             fmt::format("components of components go deeper than {} levels, the limit", kDeepest));
    BOOL isMesh = 0;
    check(NMR::lib3mf_object_ismeshobject(object, &isMesh), object);
    if (isMesh) return readMeshObject(object, placement);
    DWORD count = 0;
    check(NMR::lib3mf_componentsobject_getcomponentcount(object, &count), object);
    for (DWORD i = 0; i < count; ++i) {
      Handle component, inner;
      check(NMR::lib3mf_componentsobject_getcomponent(object, i, component.out()), object);
      NMR::MODELTRANSFORM transform{};
      check(NMR::lib3mf_component_gettransform(component.get(), &transform), component.get());
      check(NMR::lib3mf_component_getobjectresource(component.get(), inner.out()), component.get());
      readObject(inner.get(), placement.after(placementOf(transform)), depth + 1);
    }
  }

  void readMeshObject(Object object, const Placement& placement) {
    DWORD vertices = 0, triangles = 0;
    check(NMR::lib3mf_meshobject_getvertexcount(object, &vertices), object);
    check(NMR::lib3mf_meshobject_gettrianglecount(object, &triangles), object);
    // Components can repeat a mesh without end.
    constexpr std::size_t kMost = std::size_t{1} << 27;
    if (mesh_.vertexCount() + vertices > kMost)
      refuse(source_, "", fmt::format("the build has more than {} vertices, the limit", kMost));
    const auto first = static_cast<std::int64_t>(mesh_.vertexCount());
    for (DWORD v = 0; v < vertices; ++v) {
      NMR::MODELMESHVERTEX vertex{};
      check(NMR::lib3mf_meshobject_getvertex(object, v, &vertex), object);
      const Point stored(vertex.m_fPosition[0], vertex.m_fPosition[1], vertex.m_fPosition[2]);
      const Point p(placement(DVec3(stored)));
      if (!isFinite(p))
        refuse(source_, "",
               fmt::format("vertex {} of a mesh is placed at ({}, {}, {}); coordinates are finite numbers", v,
                           p.x, p.y, p.z));
      mesh_.addVertex(p);
    }
    // A mirrored solid would be inside out.
    const bool isMirrored = placement.determinant() < 0;
    for (DWORD t = 0; t < triangles; ++t) {
      NMR::MODELMESHTRIANGLE triangle{};
      check(NMR::lib3mf_meshobject_gettriangle(object, t, &triangle), object);
      std::array<std::int64_t, 3> corners = {first + triangle.m_nIndices[0], first + triangle.m_nIndices[1],
                                             first + triangle.m_nIndices[2]};
      if (isMirrored) std::swap(corners[1], corners[2]);
      if (const auto wrong = mesh_.addPolygon(corners))
        refuse(source_, "",
               fmt::format("a triangle names vertex {}, but its mesh has {}, from 0 on", *wrong - first,
                           vertices));
    }
  }

  const Source& source_;
  Handle model_;
  MeshBuilder mesh_;
};

}  // namespace

TriangleMesh read3mf(const Source& source) {
  return Reader3mf(source).read();
}

std::string write3mf(const TriangleMesh& mesh, const MeshWriteOptions& options) {
  if (mesh.triangles.empty()) throw InputError("the mesh has no triangles; a 3MF file needs some");
  for (std::size_t v = 0; v < mesh.vertices.size(); ++v)
    for (int i = 0; i < 3; ++i)
      if (!(std::fabs(mesh.vertices[v][i]) <= kLargestCoordinate))
        throw InputError(fmt::format("vertex {} has the coordinate {}; 3MF files hold coordinates up to 1e9",
                                     v, shortest(mesh.vertices[v][i])));
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const auto& [a, b, c] = mesh.triangles[t];
    if (a == b || b == c || c == a)
      throw InputError(fmt::format("triangle {} names a vertex twice; in a 3MF file its vertices differ", t));
  }
  std::string model;
  auto to = std::back_inserter(model);
  fmt::format_to(to,
                 "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n"
                 "<model unit=\"{}\" xml:lang=\"en-US\" "
                 "xmlns=\"http://schemas.microsoft.com/3dmanufacturing/core/2015/02\">\n"
                 " <resources>\n  <object id=\"1\" type=\"model\">\n   <mesh>\n    <vertices>\n",
                 nameOf(options.unit));
  for (const Point& p : mesh.vertices)
    fmt::format_to(to, "     <vertex x=\"{}\" y=\"{}\" z=\"{}\"/>\n", shortest(p.x), shortest(p.y),
                   shortest(p.z));
  model += "    </vertices>\n    <triangles>\n";
  for (const auto& t : mesh.triangles)
    fmt::format_to(to, "     <triangle v1=\"{}\" v2=\"{}\" v3=\"{}\"/>\n", t[0], t[1], t[2]);
  model +=
      "    </triangles>\n   </mesh>\n  </object>\n </resources>\n <build>\n  <item objectid=\"1\"/>\n "
      "</build>\n</model>\n";
  const std::string types =
      "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n"
      "<Types xmlns=\"http://schemas.openxmlformats.org/package/2006/content-types\">"
      "<Default Extension=\"rels\" ContentType=\"application/vnd.openxmlformats-package.relationships+xml\"/>"
      "<Default Extension=\"model\" "
      "ContentType=\"application/vnd.ms-package.3dmanufacturing-3dmodel+xml\"/></Types>\n";
  const std::string relations =
      "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n"
      "<Relationships xmlns=\"http://schemas.openxmlformats.org/package/2006/relationships\">"
      "<Relationship Target=\"/3D/3dmodel.model\" Id=\"rel0\" "
      "Type=\"http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel\"/></Relationships>\n";
  return makeZip({{"[Content_Types].xml", types}, {"_rels/.rels", relations}, {"3D/3dmodel.model", model}});
}

}  // namespace restroke::points::formats
