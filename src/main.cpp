#include "cli/program.h"

int main(int argc, char** argv) { return aligngs::run_program(argc, argv); }
