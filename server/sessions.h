#pragma once

#include <map>
#include <memory>
#include <mutex>
#include <string>

#include "core/base/progress.h"

namespace relight {

/// Clients that want no answer but that to their newest request: who sends another under the same
/// name makes the one before it stop. Any thread may call.
class Sessions {
  public:
    /// A request's place in its session, as long as this lives.
    class Turn {
      public:
        Turn(Sessions& sessions, std::string name);
        Turn(const Turn&) = delete;
        Turn& operator=(const Turn&) = delete;
        ~Turn();
        const std::shared_ptr<Progress>& progress() const { return progress_; }
        bool superseded() const;  ///< a newer request has stopped this one

      private:
        Sessions& sessions_;
        std::string name_;  ///< empty: the request belongs to no session
        std::shared_ptr<Progress> progress_ = std::make_shared<Progress>();
    };

  private:
    mutable std::mutex mutex_;
    std::map<std::string, std::shared_ptr<Progress>> newest_;
};

}  // namespace relight
