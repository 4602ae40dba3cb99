#include "server/sessions.h"

#include <utility>

namespace relight {

Sessions::Turn::Turn(Sessions& sessions, std::string name)
    : sessions_(sessions), name_(std::move(name))
{
    if (name_.empty()) { return; }
    const std::lock_guard lock(sessions_.mutex_);
    auto& newest = sessions_.newest_[name_];
    if (newest != nullptr) { newest->stop(); }
    newest = progress_;
}

Sessions::Turn::~Turn()
{
    if (name_.empty()) { return; }
    const std::lock_guard lock(sessions_.mutex_);
    const auto at = sessions_.newest_.find(name_);
    if (at != sessions_.newest_.end() && at->second == progress_) { sessions_.newest_.erase(at); }
}

bool Sessions::Turn::superseded() const
{
    if (name_.empty()) { return false; }
    const std::lock_guard lock(sessions_.mutex_);
    const auto at = sessions_.newest_.find(name_);
    return at == sessions_.newest_.end() || at->second != progress_;
}

}  // namespace relight
