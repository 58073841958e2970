/* SPDX-License-Identifier: MIT
 * nacre.c - the command: picks the verb. */
#include "apps/verbs.h"

#include "core/base.h"
#include "core/nearest_word.h"

#include <stdio.h>
#include <string.h>

static const struct {
    const char *name;
    int (*run)(int argc, char **argv);
    const char *summary;
} verbs[] = {
    {"bake", verb_bake, "capture an object's light into a field"},
    {"render", verb_render, "draw a view by one shading method"},
    {"compare", verb_compare, "measure how far an image is from its reference"},
    {"report", verb_report, "error against run time of every method, as a page"},
    {"env", verb_env, "convert an environment map between kinds and conventions"},
    {"rsibr", verb_rsibr, "compute what a material reflects toward a few eyes"},
    {"prefilter", verb_prefilter, "filter an environment map by a lobe, to a stated tolerance"},
    {"info", verb_info, "say what a scene, field, image, map or patch file holds"},
    {"bench", verb_bench, "race nacre against the limit of this machine and its peers"},
    {"check", verb_check, "measure the hazards of arithmetic against their bounds"},
};
enum { verb_count = sizeof verbs / sizeof verbs[0] };

static void print_help(FILE *out)
{
    fprintf(out, "usage: nacre VERB [...]\n\n"
                 "Right reflections of curved objects at the price of a few texture reads.\n\n");
    for (int k = 0; k < verb_count; k++)
        fprintf(out, "  %-10s %s\n", verbs[k].name, verbs[k].summary);
    fprintf(out, "\n  nacre VERB --help   options and an example\n"
                 "  nacre --version     version\n\n"
                 "example:\n"
                 "  nacre render data/scenes/gazebo.json --method trace -o teapot.png\n");
}

static int unknown_verb(const char *name)
{
    const char *names[verb_count];
    for (int k = 0; k < verb_count; k++)
        names[k] = verbs[k].name;
    const char *nearest = ncr_nearest_word(name, verb_count, names);
    fprintf(stderr, "nacre: unknown verb %s%s%s%s\n", name, nearest ? "; did you mean " : "",
            nearest ? nearest : "", nearest ? "?" : "");
    return 2;
}

int main(int argc, char **argv)
{
    if (argc < 2 || !strcmp(argv[1], "--help") || !strcmp(argv[1], "help")) {
        print_help(argc < 2 ? stderr : stdout);
        return argc < 2 ? 2 : 0;
    }
    if (!strcmp(argv[1], "--version")) {
        printf("nacre %d.%d.%d\n", NCR_VERSION_MAJOR, NCR_VERSION_MINOR, NCR_VERSION_PATCH);
        return 0;
    }
    for (int k = 0; k < verb_count; k++)
        if (!strcmp(argv[1], verbs[k].name))
            return verbs[k].run(argc - 2, argv + 2);
    return unknown_verb(argv[1]);
}
