/* lbench.h - the Lua module `bench`: references on the matrices of a scene, memory, machine.
 *
 *     b = bench.systems(scene)   assembles them for the scene as it is
 *     b:update()                 again after an edit; the analysis and Laplacian are kept
 *     b:size()                   {unknowns=, right_hand_sides=, collocation_points=, entries=}
 *     b:cholmod(threads)         {analysis=, factor=, solve=, entries=}, seconds; 0: as many as they choose
 *     b:eigen("ldlt"|"cholmod")  {factor=, solve=}: SimplicialLDLT, CholmodSupernodalLLT
 *     b:difference()             of the last solutions to the scene's fields, relative to the largest value
 *     b:release()                forgets analysis and factor
 *     bench.memory()             now, peak: MiB
 *     bench.reset_peak()         from now on
 *     bench.trim()               gives free memory back to the system
 *     bench.machine()            {cpu=, cores=, memory=, renderer=, cholmod=, openblas=, eigen=} */
#ifndef BENCH_LBENCH_H
#define BENCH_LBENCH_H

#include <lua.h>

int luaopen_bench(lua_State *L);

#endif
