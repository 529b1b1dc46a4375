// The program: command line in, exit status out.
#pragma once

namespace aligngs {

int run_program(int argc, char** argv);

}  // namespace aligngs
