#include "server/cache.h"

namespace relight {
namespace {

template <class T>
std::uint64_t bytes_of(const std::vector<T>& values)
{
    return values.capacity() * sizeof(T);
}

}  // namespace

std::uint64_t bytes_of(const Stage& stage)
{
    const Mesh& mesh = *stage.mesh;
    const Surface& surface = *stage.surface;
    return bytes_of(mesh.positions) + bytes_of(mesh.faces.indices) + bytes_of(mesh.faces.offsets) +
           bytes_of(mesh.normals) + bytes_of(mesh.colors) + bytes_of(mesh.uvs) +
           bytes_of(mesh.corner_uvs) + bytes_of(mesh.face_materials) + bytes_of(surface.triangles) +
           bytes_of(surface.triangle_face) + bytes_of(surface.normals) + bytes_of(surface.spacing) +
           stage.bvh->bytes();
}

std::shared_ptr<StageCache::Slot> StageCache::slot_of(const std::string& key)
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

void StageCache::erase(std::map<std::string, std::shared_ptr<Slot>, std::less<>>::iterator at)
{
    bytes_ -= at->second->bytes;
    recent_.erase(at->second->place);
    slots_.erase(at);
}

/// Accounts for what has been built (or not), and lets the least recently used go.
void StageCache::settle(const std::string& key, const std::shared_ptr<Slot>& slot)
{
    const std::lock_guard lock(mutex_);
    const auto own = slots_.find(key);
    if (own == slots_.end() || own->second != slot) { return; }  // forgotten meanwhile
    if (!slot->stage) {
        erase(own);
        return;
    }
    slot->bytes = bytes_of(*slot->stage);
    bytes_ += slot->bytes;
    while (bytes_ > most_ && !recent_.empty()) { erase(slots_.find(recent_.back())); }
}

Result<Stage> StageCache::stage(const std::string& key, const std::function<Result<Stage>()>& build)
{
    const auto slot = slot_of(key);
    const std::lock_guard building(slot->building);
    if (slot->stage) { return *slot->stage; }
    struct Settle {  // also when `build` throws
        StageCache& cache;
        const std::string& key;
        const std::shared_ptr<Slot>& slot;
        ~Settle() { cache.settle(key, slot); }
    };
    const Settle settle{*this, key, slot};
    auto built = build();
    if (built) { slot->stage = *built; }
    return built;
}

void StageCache::forget(std::string_view prefix)
{
    const std::lock_guard lock(mutex_);
    for (auto at = slots_.lower_bound(prefix);
         at != slots_.end() && at->first.starts_with(prefix);) {
        erase(at++);
    }
}

std::uint64_t StageCache::bytes() const
{
    const std::lock_guard lock(mutex_);
    return bytes_;
}

}  // namespace relight
