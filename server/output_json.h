#pragma once

#include "server/fields.h"
#include "server/request.h"

namespace relight {

/// "display" of the request: from radiance to color.
Display parse_display(Fields fields);

/// "output" of the request: how the answer is written.
Output parse_output(Fields fields, const ParseLimits& limits);

}  // namespace relight
