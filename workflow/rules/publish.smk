# What readers see: tables, figures, notebooks, the manifest and the report; and the proof that all of it was run.

for KEY, PAPER in PAPERS.items():
    for STAGE in ("tables", "figures"):

        rule:
            name:
                f"{STAGE}_{KEY}"
            input:
                LAYOUT.inputs(PAPER, pipeline.products(PAPER, STAGE)),
                LAYOUT.published_numbers(PAPER),
            output:
                LAYOUT.products(PAPER, STAGE),
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


PRODUCTS = [LAYOUT.products(paper, stage) for paper in PAPERS.values() for stage in ("tables", "figures")]
RECORDS = [LAYOUT.record(stage, key) for key in PAPERS for stage in ("tables", "figures")]
NOTEBOOKS = LAYOUT.notebook_sources(PAPERS)
NOTEBOOK_TARGETS = [f"{LAYOUT.notebooks}/{name}.ipynb" for name in NOTEBOOKS]


rule notebook:
    input:
        PRODUCTS,
        rules.claims.output,
        source=lambda wildcards: NOTEBOOKS[wildcards.name],
    output:
        f"{LAYOUT.notebooks}/{{name}}.ipynb",
    params:
        source=source_hash(["robins.publish.notebook"]),
    log:
        f"{LAYOUT.build}/logs/notebook/{{name}}.log",
    conda:
        "../envs/robins.yaml"
    script:
        "../scripts/notebook.py"


rule manifest:
    input:
        ROOT / "requirements.lock",
        records=[rules.claims.output[1], RECORDS],
    output:
        f"{LAYOUT.results}/manifest.json",
    params:
        config={key: configuration.digest(settings) for key, settings in SETTINGS.items()},
        source=source_hash(["robins.publish.manifest"]),
    log:
        f"{LAYOUT.build}/logs/manifest.log",
    conda:
        "../envs/robins.yaml"
    script:
        "../scripts/manifest.py"


rule report:
    input:
        PRODUCTS,
        rules.claims.output,
        rules.manifest.output,
        FIELD_TARGETS,
    output:
        f"{LAYOUT.results}/report.html",
    params:
        papers=list(PAPERS),
        source=source_hash(["robins.publish.report"]),
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
        PRODUCTS,
        rules.claims.output,
        rules.manifest.output,
        rules.report.output,
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
