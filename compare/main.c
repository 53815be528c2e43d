#include "base/heap.h"
#include "command/command.h"

int main(int argc, char **argv)
{
    pl_heap_guard_json();
    return pl_program(argc, argv);
}
