#include "server/store.h"

#include <fcntl.h>
#include <sys/file.h>

#include <algorithm>
#include <charconv>
#include <chrono>
#include <stdexcept>

namespace relight {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view object_head = "relight-object 1\n";

/// Takes the text up to the next line end.
std::optional<std::string_view> take_line(std::string_view& text)
{
    const auto end = text.find('\n');
    if (end == std::string_view::npos) { return {}; }
    const std::string_view line = text.substr(0, end);
    text.remove_prefix(end + 1);
    return line;
}

std::optional<std::uint64_t> take_number(std::string_view& text)
{
    const auto line = take_line(text);
    if (!line) { return {}; }
    std::uint64_t number = 0;
    const auto [end, error] = std::from_chars(line->data(), line->data() + line->size(), number);
    if (error != std::errc() || end != line->data() + line->size()) { return {}; }
    return number;
}

std::string written(const StoredObject& object)
{
    return std::string(object_head) + std::to_string(object.sequence) + "\n" + object.format +
           "\n" + std::to_string(object.bytes) + "\n" + object.description + "\n";
}

/// What `written` wrote; nothing if it is anything else.
std::optional<StoredObject> read_object(std::string_view id, std::string_view text)
{
    if (!text.starts_with(object_head)) { return {}; }
    text.remove_prefix(object_head.size());
    const auto sequence = take_number(text);
    const auto format = take_line(text);
    const auto bytes = take_number(text);
    const auto description = take_line(text);
    if (!sequence || !format || !bytes || !description || !text.empty()) { return {}; }
    return StoredObject{std::string(id), *sequence, std::string(*format), *bytes,
                        std::string(*description)};
}

std::uint64_t now_ns()
{
    const auto now = std::chrono::system_clock::now().time_since_epoch();
    return static_cast<std::uint64_t>(
        std::chrono::duration_cast<std::chrono::nanoseconds>(now).count());
}

}  // namespace

bool is_object_id(std::string_view text)
{
    return text.size() == 64 &&
           text.find_first_not_of("0123456789abcdef") == std::string_view::npos;
}

Store::Incoming::Incoming(fs::path path)
    : path_(std::move(path)), file_(path_, O_RDWR | O_CREAT | O_TRUNC)
{
}

Store::Incoming::~Incoming()
{
    std::error_code ignored;  // it may have been kept
    if (file_) { fs::remove(path_, ignored); }
}

void Store::Incoming::add(std::string_view bytes)
{
    file_.write(bytes);
    hash_.add(bytes);
    size_ += bytes.size();
}

Store::Store(fs::path folder) : folder_(std::move(folder))
{
    fs::create_directories(folder_);
    lock_ = File(folder_ / "lock", O_RDWR | O_CREAT);
    if (::flock(lock_.descriptor(), LOCK_EX | LOCK_NB) != 0) {
        throw std::runtime_error("another server is using this store");
    }
    scan();
}

fs::path Store::bytes_path(std::string_view id) const
{
    return folder_ / (std::string(id) + ".bytes");
}
fs::path Store::object_path(std::string_view id) const
{
    return folder_ / (std::string(id) + ".object");
}

void Store::sync_folder() const
{
    File(folder_, O_RDONLY | O_DIRECTORY).sync();
}

void Store::scan()
{
    for (const fs::directory_entry& entry : fs::directory_iterator(folder_)) {
        const fs::path& path = entry.path();
        const std::string stem = path.stem().string();
        std::error_code error;
        if (!entry.is_regular_file(error)) { continue; }
        if (stem.starts_with("incoming-") && path.extension() == ".part") {
            fs::remove(path, error);  // of a server that stopped in the middle
            continue;
        }
        if (!is_object_id(stem)) { continue; }
        if (path.extension() == ".bytes" && !fs::exists(object_path(stem), error)) {
            fs::remove(path, error);  // its description never came: it was not promised to anyone
        }
        if (path.extension() != ".object") { continue; }
        const auto text = File(path, O_RDONLY).read_all();
        auto object = read_object(stem, {reinterpret_cast<const char*>(text.data()), text.size()});
        if (!object || fs::file_size(bytes_path(stem), error) != object->bytes || error ||
            order_.contains(object->sequence)) {
            continue;
        }
        order_[object->sequence] = stem;
        objects_[stem] = std::move(*object);
    }
}

Store::Incoming Store::begin()
{
    const std::lock_guard lock(mutex_);
    return Incoming(folder_ / ("incoming-" + std::to_string(incoming_++) + ".part"));
}

StoredObject Store::keep(Incoming incoming, const std::string& id, std::string format,
                         std::string description)
{
    incoming.file_.sync();
    Incoming sidecar = begin();
    const std::lock_guard lock(mutex_);
    if (const auto held = objects_.find(id); held != objects_.end()) { return held->second; }
    const std::uint64_t last = order_.empty() ? 0 : order_.rbegin()->first;
    StoredObject object{id, std::max(now_ns(), last + 1), std::move(format), incoming.size(),
                        std::move(description)};
    sidecar.add(written(object));
    sidecar.file_.sync();
    fs::rename(incoming.path_, bytes_path(id));
    sync_folder();
    fs::rename(sidecar.path_, object_path(id));
    sync_folder();
    order_[object.sequence] = id;
    return objects_[id] = std::move(object);
}

std::optional<StoredObject> Store::find(std::string_view id) const
{
    const std::lock_guard lock(mutex_);
    const auto at = objects_.find(id);
    if (at == objects_.end()) { return {}; }
    return at->second;
}

std::vector<StoredObject> Store::list(std::size_t limit, std::uint64_t before) const
{
    const std::lock_guard lock(mutex_);
    std::vector<StoredObject> page;
    auto at = order_.lower_bound(before);
    while (at != order_.begin() && page.size() < limit) {
        --at;
        page.push_back(objects_.find(at->second)->second);
    }
    return page;
}

File Store::open(std::string_view id) const
{
    const std::lock_guard lock(mutex_);
    return objects_.contains(id) ? File(bytes_path(id), O_RDONLY) : File();
}

bool Store::erase(std::string_view id)
{
    const std::lock_guard lock(mutex_);
    const auto at = objects_.find(id);
    if (at == objects_.end()) { return false; }
    fs::remove(object_path(id));
    sync_folder();
    fs::remove(bytes_path(id));
    order_.erase(at->second.sequence);
    objects_.erase(at);
    return true;
}

}  // namespace relight
