/* SPDX-License-Identifier: MIT
 * verbs.h - the verbs of the nacre command: each takes what follows its name, gives an exit code. */
#ifndef NCR_APPS_VERBS_H
#define NCR_APPS_VERBS_H

int verb_bake(int argc, char **argv);
int verb_render(int argc, char **argv);
int verb_compare(int argc, char **argv);
int verb_report(int argc, char **argv);
int verb_env(int argc, char **argv);
int verb_rsibr(int argc, char **argv);
int verb_prefilter(int argc, char **argv);
int verb_info(int argc, char **argv);
int verb_bench(int argc, char **argv);
int verb_check(int argc, char **argv);

#endif
