#pragma once

#include <cstdint>
#include <functional>
#include <list>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <string_view>

#include "core/base/result.h"
#include "core/trace/stage.h"

namespace relight {

/// Stages by what they depend on, kept as long as `bytes` allow, the least recently used leaving
/// first. Who asks for one that is being built waits for it. Any thread may call.
class StageCache {
  public:
    explicit StageCache(std::uint64_t bytes) : most_(bytes) {}

    /// The stage of `key`, built by `build` if it is not held. A build that fails is not kept.
    Result<Stage> stage(const std::string& key, const std::function<Result<Stage>()>& build);

    /// Forgets every stage whose key starts with `prefix`.
    void forget(std::string_view prefix);

    std::uint64_t bytes() const;  ///< held now

  private:
    struct Slot {
        std::mutex building;
        std::optional<Stage> stage;  // guarded by `building`
        std::uint64_t bytes = 0;     // these two by the cache's mutex
        std::list<std::string>::iterator place;
    };
    std::shared_ptr<Slot> slot_of(const std::string& key);
    void settle(const std::string& key, const std::shared_ptr<Slot>& slot);
    void erase(std::map<std::string, std::shared_ptr<Slot>, std::less<>>::iterator at);

    std::uint64_t most_;
    mutable std::mutex mutex_;
    std::map<std::string, std::shared_ptr<Slot>, std::less<>> slots_;
    std::list<std::string> recent_;  // keys, most recent first
    std::uint64_t bytes_ = 0;
};

/// Memory a stage holds.
std::uint64_t bytes_of(const Stage& stage);

}  // namespace relight
