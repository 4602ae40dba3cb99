#include "server/cache.h"

#include <chrono>

#include "server/timed.h"

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

std::uint64_t bytes_of(const Model& model)
{
    const Surface& surface = *model.stage.surface;
    const Mesh* const lit = model.stage.mesh.get();
    const bool refined = lit != &model.asset->mesh;
    return bytes_of(*lit) + (refined ? bytes_of(model.asset->mesh) : 0) +
           bytes_of(surface.triangles) + bytes_of(surface.triangle_face) +
           bytes_of(surface.normals) + bytes_of(surface.smooth_normals) +
           bytes_of(surface.spacing) + bytes_of(surface.bend) + bytes_of(surface.vertex_groups) +
           bytes_of(surface.tangents) + bytes_of(surface.order) + surface.ordered.bytes() +
           model.stage.bvh->bytes();
}

std::uint64_t bytes_of(const SharedMap& map)
{
    return map->bytes();
}

std::uint64_t bytes_of(const SharedColumn& column)
{
    return bytes_of(column->E) + bytes_of(column->visible.share) + bytes_of(column->visible.bits) +
           bytes_of(column->E_bounced) + bytes_of(column->standard_error) + bytes_of(column->Lo) +
           bytes_of(column->ambient_occlusion) + bytes_of(column->sh);
}

}  // namespace

std::uint64_t bytes_of(const Kept& kept)
{
    return std::visit([](const auto& value) { return bytes_of(value); }, kept);
}

Result<Kept> Cache::find_or_build(const std::string& key, Progress& progress,
                                  const std::function<Result<Kept>()>& build)
{
    constexpr std::chrono::milliseconds glance{5};  // between looks at progress
    std::unique_lock lock(mutex_);
    std::shared_ptr<Slot> slot;
    while (true) {
        auto& place = slots_[key];
        if (!place) { place = std::make_shared<Slot>(); }
        slot = place;
        if (!slot->building) { break; }
        if (progress.stopped()) { return cancelled(); }
        built_.wait_for(lock, glance);
    }
    if (slot->value) {
        Kept found = *slot->value;
        keep(key, *slot);
        return found;
    }
    slot->building = true;
    lock.unlock();
    struct Settle {  // also when `build` throws
        Cache& cache;
        std::unique_lock<std::mutex>& lock;
        const std::string& key;
        Slot& slot;
        ~Settle()
        {
            if (!lock.owns_lock()) { lock.lock(); }
            slot.building = false;
            cache.keep(key, slot);
            cache.built_.notify_all();
        }
    };
    const Settle settle{*this, lock, key, *slot};
    const auto start = std::chrono::steady_clock::now();
    auto built = build();
    lock.lock();
    if (built) {
        slot->seconds =
            std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
        slot->value = *built;
    }
    return built;
}

/// Accounts for a slot's value, just built or asked for again, and lets the least worth go. A slot
/// without a value goes itself.
void Cache::keep(const std::string& key, Slot& slot)
{
    const auto at = slots_.find(key);
    if (at == slots_.end() || at->second.get() != &slot) { return; }  // forgotten meanwhile
    if (slot.bytes > 0) {
        bytes_ -= slot.bytes;
        worth_.erase(slot.worth);
        slot.bytes = 0;
    }
    const std::uint64_t bytes = slot.value ? bytes_of(*slot.value) : 0;
    if (bytes == 0 || bytes > most_) {
        slots_.erase(at);
        return;
    }
    slot.bytes = bytes;
    slot.worth = worth_.emplace(floor_ + slot.seconds / static_cast<double>(slot.bytes), key);
    bytes_ += slot.bytes;
    while (bytes_ > most_) {
        floor_ = worth_.begin()->first;
        drop(slots_.find(worth_.begin()->second));
    }
}

void Cache::drop(Slots::iterator at)
{
    if (at->second->bytes > 0) {
        bytes_ -= at->second->bytes;
        worth_.erase(at->second->worth);
    }
    slots_.erase(at);
}

void Cache::replace(const std::string& key, Kept better)
{
    const std::lock_guard lock(mutex_);
    const auto at = slots_.find(key);
    if (at == slots_.end() || !at->second->value) { return; }
    at->second->value = std::move(better);
    keep(key, *at->second);
}

void Cache::forget(std::string_view prefix)
{
    const std::lock_guard lock(mutex_);
    for (auto at = slots_.lower_bound(prefix);
         at != slots_.end() && at->first.starts_with(prefix);) {
        drop(at++);
    }
}

std::uint64_t Cache::bytes() const
{
    const std::lock_guard lock(mutex_);
    return bytes_;
}

}  // namespace relight
