# What readers see: tables, figures, notebooks, the manifest and the report; and the proof that all of it was run.

for KEY, PAPER in PAPERS.items():
    for STAGE in ("tables", "figures"):

        rule:
            name:
                f"{STAGE}_{KEY}"
            input:
                LAYOUT.inputs(PAPER, pipeline.products(PAPER, STAGE)),
            output:
                update(LAYOUT.products(PAPER, STAGE)),
                LAYOUT.record(STAGE, KEY),
            params:
                paper=KEY,
                stage=STAGE,
                source=SOURCES[KEY].stage(STAGE),
            log:
                f"{LAYOUT.build}/logs/{KEY}/{STAGE}.log",
            conda:
                "../envs/robins.yaml"
            script:
                "../scripts/publish.py"


rule notebook:
    input:
        RECORDS,
        CLAIMS,
        MANIFEST,
        FIELD_TARGETS,
    output:
        update(f"{LAYOUT.notebooks}/{{name}}.ipynb"),
    params:
        source=lambda wildcards: source_hash(
            ["robins.publish.notebook"], {"notebook": NOTEBOOKS[wildcards.name].read_text()}
        ),
    log:
        f"{LAYOUT.build}/logs/notebook/{{name}}.log",
    conda:
        "../envs/robins.yaml"
    script:
        "../scripts/notebook.py"


rule manifest:
    input:
        [LAYOUT.record("claims"), RECORDS],
    output:
        update(MANIFEST),
    params:
        config={key: configuration.digest(settings) for key, settings in SETTINGS.items()},
        source=source_hash(["robins.publish.manifest"], {"lock": (ROOT / "requirements.lock").read_text()}),
    log:
        f"{LAYOUT.build}/logs/manifest.log",
    conda:
        "../envs/robins.yaml"
    script:
        "../scripts/manifest.py"


rule report:
    input:
        RECORDS,
        CLAIMS,
        MANIFEST,
        FIELD_TARGETS,
    output:
        update(REPORT),
    params:
        papers=list(PAPERS),
        source=fingerprint(PAPERS),
    log:
        f"{LAYOUT.build}/logs/report.log",
    conda:
        "../envs/robins.yaml"
    script:
        "../scripts/report.py"


# Never versioned: a fresh clone has the results but not this, whose inputs are all the intermediates.
rule complete:
    input:
        [LAYOUT.intermediates(paper) for paper in PAPERS.values()],
        RECORDS,
        CLAIMS,
        MANIFEST,
        REPORT,
        NOTEBOOK_TARGETS,
        FIELD_TARGETS,
    output:
        f"{LAYOUT.sentinel}/complete.json",
        f"{LAYOUT.sentinel}/run-info.json",
    log:
        f"{LAYOUT.build}/logs/complete.log",
    conda:
        "../envs/robins.yaml"
    script:
        "../scripts/complete.py"
