/* SPDX-License-Identifier: MIT
 * options.h - command lines as tables: long options, a few letters, positional words, help. */
#ifndef NCR_APPS_OPTIONS_H
#define NCR_APPS_OPTIONS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

typedef enum option_kind {
    OPTION_FLAG,   /* bool * */
    OPTION_TEXT,   /* const char ** */
    OPTION_COUNT,  /* uint32_t *: a whole number from 1 */
    OPTION_SEED,   /* uint64_t * */
    OPTION_NUMBER, /* double *: finite and above 0 */
    OPTION_SIZE,   /* uint32_t [2]: WxH */
} option_kind;

typedef struct option {
    const char *name; /* "--threads" */
    char letter;      /* 'o' for -o, or 0 */
    option_kind kind;
    void *target;
    const char *value; /* what help calls the value: "N" */
    const char *help;  /* one line; NULL-named row ends a table */
} option;

/** One command: its tables and texts. `words` are the positional arguments, all required unless
 *  `word_total` asks how many there were. */
typedef struct command_line {
    const char *usage;     /* "nacre bake SCENE -o FIELD [options]" */
    const char *summary;   /* one sentence */
    const char *example;   /* one or more lines, each a command */
    const option *options; /* ends with a NULL name */
    size_t word_count;
    const char *word_names[4];
    const char **words; /* [word_count] filled */
    size_t *word_total; /* NULL, or where to count them: then none is required */
} command_line;

typedef enum parse_result { PARSE_OK = 0, PARSE_HELP, PARSE_WRONG } parse_result;

/** Parse argv[0..argc): options anywhere, `--` ends them, `--name=value` and `--name value` alike.
 *  PARSE_HELP after printing help to stdout; PARSE_WRONG after one sentence on stderr that offers
 *  the nearest option. */
parse_result command_line_parse(const command_line *line, int argc, char **argv);

/** Say on stderr that something required is missing; returns exit code 2. */
int command_line_missing(const char *what);

void command_line_help(const command_line *line, FILE *out);

#endif
