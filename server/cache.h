#pragma once

#include <atomic>
#include <condition_variable>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <variant>

#include "core/asset.h"
#include "core/base/progress.h"
#include "core/base/result.h"
#include "core/light/environment.h"
#include "core/trace/stage.h"
#include "core/transport/transport.h"

namespace relight {

using SharedMap = std::shared_ptr<const EnvironmentMap>;

/// How much has been asked of a tree that was built in haste.
struct TreeUse {
    std::atomic<std::uint64_t> rays{0};
    std::atomic<bool> upgrading{false};
};

/// A client's file made ready for light: what it brings, and the stage of its geometry (refined, if
/// that was asked for).
struct Model {
    std::shared_ptr<const Asset> asset;
    Stage stage;
    std::string key;  ///< what it is kept under, and what is derived from it begins with; empty: it
                      ///< stood in the request and is not kept
    std::shared_ptr<TreeUse> use = std::make_shared<TreeUse>();
};

/// What is kept between requests.
using Kept = std::variant<Model, SharedMap, SharedColumn>;

/// Memory that it holds.
std::uint64_t bytes_of(const Kept& kept);

/// Values by what they depend on, kept as long as `bytes` allow. When room is needed, that one
/// leaves which saves the least time a byte, the longer it has not been asked for the sooner
/// (GreedyDual-Size, Cao & Irani 1997). Who asks for one that is being built waits for it.
/// Any thread may call.
class Cache {
  public:
    explicit Cache(std::uint64_t bytes) : most_(bytes) {}

    /// The value of `key`, built by `build` if it is not held. A build that fails is not kept.
    /// Errors: build's; Cancelled if progress is stopped while another builds it.
    template <class Value>
    Result<Value> get(const std::string& key, Progress& progress,
                      const std::function<Result<Value>()>& build)
    {
        return find_or_build(key, progress,
                             [&] {
                                 return build().transform(
                                     [](Value&& value) { return Kept(std::move(value)); });
                             })
            .transform([](Kept&& kept) { return std::get<Value>(std::move(kept)); });
    }

    /// Gives `key` a better value, if it is held still.
    void replace(const std::string& key, Kept better);

    /// Forgets every value whose key starts with `prefix`.
    void forget(std::string_view prefix);

    std::uint64_t bytes() const;  ///< held now

  private:
    struct Slot {
        bool building = false;
        std::optional<Kept> value;
        std::uint64_t bytes = 0;
        double seconds = 0.0;                                     // that building took
        std::multimap<double, std::string>::iterator worth = {};  // of a value that is there
    };
    using Slots = std::map<std::string, std::shared_ptr<Slot>, std::less<>>;
    Result<Kept> find_or_build(const std::string& key, Progress& progress,
                               const std::function<Result<Kept>()>& build);
    void keep(const std::string& key, Slot& slot);
    void drop(Slots::iterator at);

    std::uint64_t most_;
    mutable std::mutex mutex_;  // of all that follows, slots included
    std::condition_variable built_;
    Slots slots_;
    std::multimap<double, std::string> worth_;  // keys of the values, the least worth first
    double floor_ = 0.0;                        // worth of what left last
    std::uint64_t bytes_ = 0;
};

}  // namespace relight
