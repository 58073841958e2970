/* SPDX-License-Identifier: MIT */
#include "apps/report_rows.h"

#include <string.h>

ncr_status report_table_add(report_table *table, const report_row *row)
{
    if (table->count == table->capacity) {
        const size_t capacity = table->capacity ? 2 * table->capacity : 32;
        report_row *rows = ncr_alloc(table->ctx, capacity * sizeof *rows);
        if (!rows)
            return NCR_E_NOMEM;
        if (table->count)
            memcpy(rows, table->rows, table->count * sizeof *rows);
        ncr_free(table->ctx, table->rows);
        table->rows = rows;
        table->capacity = capacity;
    }
    table->rows[table->count++] = *row;
    return NCR_OK;
}

void report_table_dispose(report_table *table)
{
    ncr_free(table->ctx, table->rows);
    *table = (report_table){.ctx = table->ctx};
}

const report_row *report_table_find(const report_table *table, const char *experiment,
                                    const char *method, uint32_t cube)
{
    for (size_t k = 0; k < table->count; k++) {
        const report_row *row = &table->rows[k];
        if (row->cube == cube && !strcmp(row->experiment, experiment) &&
            !strcmp(row->method, method))
            return row;
    }
    return NULL;
}

static bool appears_before(const report_table *table, size_t row)
{
    for (size_t k = 0; k < row; k++)
        if (!strcmp(table->rows[k].experiment, table->rows[row].experiment))
            return true;
    return false;
}

const char *report_table_experiment(const report_table *table, size_t k)
{
    for (size_t row = 0; row < table->count; row++)
        if (!appears_before(table, row) && k-- == 0)
            return table->rows[row].experiment;
    return NULL;
}
