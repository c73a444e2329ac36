#include "cli/command.h"

int main(int argc, char **argv)
{
    return shv_program(argc, argv);
}
