#pragma once

#include <cstdint>
#include <functional>
#include <list>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>

#include "core/asset.h"
#include "core/base/result.h"
#include "core/light/environment.h"
#include "core/trace/stage.h"

namespace relight {

using SharedMap = std::shared_ptr<const EnvironmentMap>;

/// A client's file made ready for light: what it brings, and the stage of its geometry (refined, if
/// that was asked for).
struct Model {
    std::shared_ptr<const Asset> asset;
    Stage stage;
};

/// Memory that a value holds.
std::uint64_t bytes_of(const Model& model);
std::uint64_t bytes_of(const SharedMap& map);

/// Values by what they depend on, kept as long as `bytes` allow, the least recently used leaving
/// first. Who asks for one that is being built waits for it. Any thread may call.
template <class Value>
class Cache {
  public:
    explicit Cache(std::uint64_t bytes) : most_(bytes) {}

    /// The value of `key`, built by `build` if it is not held. A build that fails is not kept.
    Result<Value> get(const std::string& key, const std::function<Result<Value>()>& build);

    /// Forgets every value whose key starts with `prefix`.
    void forget(std::string_view prefix);

    std::uint64_t bytes() const;  ///< held now

  private:
    struct Slot {
        std::mutex building;
        std::optional<Value> value;  // guarded by `building`
        std::uint64_t bytes = 0;     // these two by the cache's mutex
        std::list<std::string>::iterator place;
    };
    using Slots = std::map<std::string, std::shared_ptr<Slot>, std::less<>>;
    std::shared_ptr<Slot> slot_of(const std::string& key);
    void settle(const std::string& key, const std::shared_ptr<Slot>& slot);
    void erase(typename Slots::iterator at);

    std::uint64_t most_;
    mutable std::mutex mutex_;
    Slots slots_;
    std::list<std::string> recent_;  // keys, most recent first
    std::uint64_t bytes_ = 0;
};

using ModelCache = Cache<Model>;
using SkyCache = Cache<SharedMap>;

}  // namespace relight
