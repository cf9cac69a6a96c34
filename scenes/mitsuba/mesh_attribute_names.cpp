#include "scenes/mitsuba/mesh_attribute_names.h"

#include <fmt/format.h>

#include <set>

#include "scenes/textures.h"

namespace penumbra::mitsuba {
namespace {

class Search {
 public:
  Search(const Context& context, MeshAttributeNames& names) : context_(context), names_(names) {}

  void visit(const Object& object) {
    if (!visited_.insert(&object).second) return;
    if (object.type == MeshAttributeTexture::kPlugin) add(object);
    for (const Child& child : object.children) {
      const auto named = context_.tree.by_id.find(child.reference);
      const Object* inside = child.object != nullptr              ? child.object
                             : named != context_.tree.by_id.end() ? named->second
                                                                  : nullptr;  // reported elsewhere
      if (inside != nullptr && inside->tag != "shape") visit(*inside);
    }
  }

 private:
  void add(const Object& texture) {
    for (const Parameter& each : texture.parameters) {
      const auto* name = std::get_if<std::string>(&each.value);
      if (each.name != "name" || name == nullptr) continue;
      set("vertex_", *name, names_.vertex, vertex_known_, each);
      set("face_", *name, names_.face, face_known_, each);
    }
  }
  void set(std::string_view prefix, std::string_view name, std::string& wanted, bool& known,
           const Parameter& at) {
    if (!name.starts_with(prefix)) return;
    const std::string own(name.substr(prefix.size()));
    if (known && own != wanted)
      context_.diagnostics.error(
          at.value_location,
          fmt::format("textures show {0}{1} and {0}{2} of one shape; a mesh has one of them", prefix, wanted,
                      own));
    wanted = own;
    known = true;
  }

  const Context& context_;
  MeshAttributeNames& names_;
  bool vertex_known_ = false, face_known_ = false;
  std::set<const Object*> visited_;
};

}  // namespace

MeshAttributeNames mesh_attribute_names(const Context& context, const Object& shape) {
  MeshAttributeNames names;
  Search(context, names).visit(shape);
  return names;
}

}  // namespace penumbra::mitsuba
