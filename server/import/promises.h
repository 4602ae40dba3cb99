#pragma once

#include "core/asset.h"

namespace relight {

/// True if all holds that Mesh, Asset and what they are made of say of themselves: every index in
/// range, every number finite and where its kind may be, every array empty or as long as it must
/// be, the pieces end to end over all the vertices. Of lights: the kinds that a file can hold.
bool keeps_promises(const Asset& asset);

}  // namespace relight
