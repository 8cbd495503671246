# Real recordings: results/field/, with a manifest of its own. Without the configuration's `recordings` this part is
# skipped and what lies in results/field/ is neither written nor deleted.

FIELD_TARGETS = [f"{LAYOUT.results}/field/manifest.json", f"{LAYOUT.build}/field/complete.json"] if RECORDING else []


# The tables and figures are those that the manifest lists; it is written last. The second output is never versioned,
# so that a fresh clone with a recording runs this rule although the first is there.
rule field:
    input:
        [RECORDING] if RECORDING else [],
    output:
        update(f"{LAYOUT.results}/field/manifest.json"),
        f"{LAYOUT.build}/field/complete.json",
    params:
        seed=CONFIGURATION.seed,
        source=source_hash(["robins.field.lasergyro", "robins.publish.tables", "robins.publish.style"]),
    log:
        f"{LAYOUT.build}/logs/field.log",
    conda:
        "../envs/robins.yaml"
    script:
        "../scripts/field.py"
