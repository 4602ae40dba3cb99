#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "server/file.h"
#include "server/sha256.h"

namespace relight {

/// A file kept by the store.
struct StoredObject {
    std::string id;            ///< SHA-256 of its bytes, 64 hex digits
    std::uint64_t sequence{};  ///< later ones are greater
    std::string format;        ///< "ply"
    std::uint64_t bytes{};
    std::string description;  ///< JSON
};

/// True for 64 lower-case hex digits, the only names that ever meet the file system.
bool is_object_id(std::string_view text);

/// A content-addressed folder: `<id>.bytes` beside `<id>.object` (its description). Both are
/// written under another name, synced and renamed, the description last: an object is there wholly
/// or not at all, whenever the machine stops. Files of other names are left alone. Any thread may
/// call.
class Store {
  public:
    /// A file on its way in; forgotten unless kept.
    class Incoming {
      public:
        Incoming(Incoming&&) noexcept = default;
        ~Incoming();
        void add(std::string_view bytes);
        std::uint64_t size() const { return size_; }
        std::vector<std::byte> read_all() const { return file_.read_all(); }
        std::string finish() { return hash_.hex(); }  ///< its id, once all bytes are added

      private:
        friend class Store;
        explicit Incoming(std::filesystem::path path);
        std::filesystem::path path_;
        File file_;
        Sha256 hash_;
        std::uint64_t size_ = 0;
    };

    /// Opens or makes the folder and reads what it holds. Throws std::runtime_error if another
    /// server has it, std::system_error if it cannot be used.
    explicit Store(std::filesystem::path folder);

    Incoming begin();
    /// Keeps the file under `id`. An object that is held already stays as it is.
    StoredObject keep(Incoming incoming, const std::string& id, std::string format,
                      std::string description);

    std::optional<StoredObject> find(std::string_view id) const;
    /// Newest first, those of a sequence below `before`.
    std::vector<StoredObject> list(std::size_t limit, std::uint64_t before) const;
    /// The bytes; a File that is not open if there is no such object.
    File open(std::string_view id) const;
    bool erase(std::string_view id);

  private:
    std::filesystem::path bytes_path(std::string_view id) const;
    std::filesystem::path object_path(std::string_view id) const;
    void scan();
    void sync_folder() const;

    std::filesystem::path folder_;
    File lock_;
    mutable std::mutex mutex_;
    std::map<std::string, StoredObject, std::less<>> objects_;
    std::map<std::uint64_t, std::string> order_;  // sequence -> id
    std::uint64_t incoming_ = 0;                  // names them
};

}  // namespace relight
