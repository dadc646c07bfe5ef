/* mesher_main.c - the program sinew-mesher, see mesher.h. */
#include "tetra/mesher.h"

int main(void)
{
    return sn_child_serve(sn_mesher_serve);
}
