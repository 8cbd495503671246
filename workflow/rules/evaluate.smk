# Verdicts: every claim of a paper, and the ledger of all papers.


rule evaluate:
    input:
        lambda wildcards: LAYOUT.inputs(PAPERS[wildcards.paper], PAPERS[wildcards.paper].claims),
    output:
        f"{LAYOUT.build}/{{paper}}/evaluate/claims.parquet",
    params:
        paper="{paper}",
        source=lambda wildcards: SOURCES[wildcards.paper].result(pipeline.CLAIMS),
    log:
        f"{LAYOUT.build}/logs/{{paper}}/evaluate.log",
    conda:
        "../envs/robins.yaml"
    script:
        "../scripts/evaluate.py"


rule claims:
    input:
        [LAYOUT.outputs(paper, pipeline.CLAIMS) for paper in PAPERS.values()],
    output:
        update(CLAIMS),
        LAYOUT.record("claims"),
    params:
        source={key: sources.result(pipeline.CLAIMS) for key, sources in SOURCES.items()},
    log:
        f"{LAYOUT.build}/logs/claims.log",
    conda:
        "../envs/robins.yaml"
    script:
        "../scripts/claims.py"
