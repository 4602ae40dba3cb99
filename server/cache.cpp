#include "server/cache.h"

namespace relight {
namespace {

template <class T>
std::uint64_t bytes_of(const std::vector<T>& values)
{
    return values.capacity() * sizeof(T);
}

std::uint64_t bytes_of(const Mesh& mesh)
{
    std::uint64_t textures = 0;
    for (const Texture& texture : mesh.textures) { textures += bytes_of(texture.texels); }
    return bytes_of(mesh.positions) + bytes_of(mesh.absent) + bytes_of(mesh.faces.indices) +
           bytes_of(mesh.faces.offsets) + bytes_of(mesh.normals) + bytes_of(mesh.colors) +
           bytes_of(mesh.uvs) + bytes_of(mesh.uvs_1) + bytes_of(mesh.corner_uvs) +
           bytes_of(mesh.tangents) + bytes_of(mesh.face_materials) + textures;
}

}  // namespace

std::uint64_t bytes_of(const Model& model)
{
    const Surface& surface = *model.stage.surface;
    const Mesh* const lit = model.stage.mesh.get();
    const bool refined = lit != &model.asset->mesh;
    return bytes_of(*lit) + (refined ? bytes_of(model.asset->mesh) : 0) +
           bytes_of(surface.triangles) + bytes_of(surface.triangle_face) +
           bytes_of(surface.normals) + bytes_of(surface.smooth_normals) +
           bytes_of(surface.spacing) + bytes_of(surface.bend) + bytes_of(surface.vertex_groups) +
           bytes_of(surface.tangents) + model.stage.bvh->bytes();
}

std::uint64_t bytes_of(const SharedMap& map)
{
    return map->bytes();
}

template <class Value>
std::shared_ptr<typename Cache<Value>::Slot> Cache<Value>::slot_of(const std::string& key)
{
    const std::lock_guard lock(mutex_);
    auto& slot = slots_[key];
    if (!slot) {
        slot = std::make_shared<Slot>();
        slot->place = recent_.insert(recent_.begin(), key);
    } else {
        recent_.splice(recent_.begin(), recent_, slot->place);
    }
    return slot;
}

template <class Value>
void Cache<Value>::erase(typename Slots::iterator at)
{
    bytes_ -= at->second->bytes;
    recent_.erase(at->second->place);
    slots_.erase(at);
}

/// Accounts for what has been built (or not), and lets the least recently used go.
template <class Value>
void Cache<Value>::settle(const std::string& key, const std::shared_ptr<Slot>& slot)
{
    const std::lock_guard lock(mutex_);
    const auto own = slots_.find(key);
    if (own == slots_.end() || own->second != slot) { return; }  // forgotten meanwhile
    if (!slot->value) {
        erase(own);
        return;
    }
    slot->bytes = bytes_of(*slot->value);
    bytes_ += slot->bytes;
    while (bytes_ > most_ && !recent_.empty()) { erase(slots_.find(recent_.back())); }
}

template <class Value>
Result<Value> Cache<Value>::get(const std::string& key, const std::function<Result<Value>()>& build)
{
    const auto slot = slot_of(key);
    const std::lock_guard building(slot->building);
    if (slot->value) { return *slot->value; }
    struct Settle {  // also when `build` throws
        Cache& cache;
        const std::string& key;
        const std::shared_ptr<Slot>& slot;
        ~Settle() { cache.settle(key, slot); }
    };
    const Settle settle{*this, key, slot};
    auto built = build();
    if (built) { slot->value = *built; }
    return built;
}

template <class Value>
void Cache<Value>::forget(std::string_view prefix)
{
    const std::lock_guard lock(mutex_);
    for (auto at = slots_.lower_bound(prefix);
         at != slots_.end() && at->first.starts_with(prefix);) {
        erase(at++);
    }
}

template <class Value>
std::uint64_t Cache<Value>::bytes() const
{
    const std::lock_guard lock(mutex_);
    return bytes_;
}

template class Cache<Model>;
template class Cache<SharedMap>;

}  // namespace relight
