// `aligngs edit RUN --list`: the edits, the objects with their sizes, and the selections by hand.
#pragma once

#include "cli/command.h"
#include "edit/edit_session.h"

namespace aligngs {

void list_run(const CommandContext& context, EditSession& session);

}  // namespace aligngs
